// Traces point samples at the corners of pixels, and divides pixels recursively into 2x2 cells. Cells share
// corners, but each point is traced only once.
#pragma once

#include <cstdint>
#include <functional>

#include "records/record.h"
#include "tracer/recording/small_things.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

struct SubdivisionSettings {
    int levels = 0;  ///< greatest depth of the subdivision, 0 to 8
    /// Greatest depth of subdivision at the edges of objects, at most `levels`. Cells near narrow objects
    /// (SmallThings) may be deeper.
    int edge_levels = 8;
    /// A cell is divided if the contrast of a colour channel exceeds this value. The contrast is (max - min)
    /// / (max + min + 0.05) over the corners of the cell.
    double threshold = 0.1;
    int colour_levels = 8;  ///< greatest depth to which colour contrast subdivides
};

/// The pixels to sample, [x_begin, x_end) x [y_begin, y_end). Samples lie at pixel corners, so those at
/// column x_end and row y_end are recorded too.
struct SampledWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Traces the window in bands of rows and passes each complete band to `take`, from top to bottom. A cell is
/// divided in any of these cases:
/// - Its corners show different objects or different parts of an object (down to `edge_levels`).
/// - The colours at its corners, or the texture between them, have a contrast above `threshold` (down to
/// `colour_levels`).
/// - All its corners show the same part of a mesh, but the outline of another part crosses the cell in front
/// of it (down to `edge_levels`).
/// - Its corners are shadowed from different lights (down to `colour_levels`).
/// - It is a pixel beside a divided pixel in its row, and its centre differs from its corners by these
/// criteria.
/// - A narrow object in `things` may lie in it (down to `levels`).
///
/// The criteria of objects, contrast and shadows also apply to every hidden layer.
///
/// Needs memory for one band only. The result does not depend on the number of threads. If the window
/// includes the row above a given row, the records of this row do not depend on rows farther above. The means
/// over lobes (lobe_means.h) are an exception. Returns the number of rays.
RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things = {});

}  // namespace postlens
