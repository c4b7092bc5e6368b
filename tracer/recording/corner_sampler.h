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
    /// Greatest depth to which edges subdivide, at most `levels`. Deeper levels are only for narrow objects
    /// (SmallThings).
    int edge_levels = 8;
    /// a cell is divided if (max - min) / (max + min + 0.05) of a colour channel exceeds this value
    double threshold = 0.1;
    int colour_levels = 8;  ///< greatest depth to which colour contrast subdivides
};

/// The pixels [x_begin, x_end) x [y_begin, y_end) to sample. The pixel corners at column x_end and row y_end
/// are recorded too.
struct SampledWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Traces the window in bands of rows and passes each complete band to `take`, from top to bottom. A cell is
/// divided
/// - if the primary ids of its corners differ, or the parts of the object, down to `edge_levels`;
/// - if the contrast of its corners' colours, or of the texture between them, exceeds `threshold`, down to
/// `colour_levels`;
/// - if the outline of a part of a mesh crosses it, in front of the surface that its corners show, although
/// no corner shows this part, down to `edge_levels`;
/// - if its corners are shadowed from different lights, down to `colour_levels`;
/// - if it is a pixel beside a divided pixel, and its centre differs from its corners by these criteria;
/// - if the narrow objects in `things` require it, down to `levels`.
/// The criteria of ids, contrast and shadows also apply to every hidden layer. Needs memory for one band
/// only. The result does not depend on the number of threads. If the row above a row is in the window, the
/// records of the row do not depend on any other rows above it, except for means over lobes (lobe_means.h).
/// Returns the number of rays.
RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things = {});

}  // namespace postlens
