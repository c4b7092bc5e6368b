// Traces point samples at the corners of pixels, and divides pixels recursively into 2x2 cells.
// Each point is traced only once, although cells share corners.
#pragma once

#include <cstdint>
#include <functional>

#include "records/record.h"
#include "tracer/recording/small_things.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

struct SubdivisionSettings {
    int levels = 0;  ///< greatest depth of the subdivision, 0 to 8
    /// Greatest number of times that a pixel is divided into quarters where edges of objects cross it; at
    /// most `levels`. There is one exception: near objects narrower than 1.5 px, quadtree cells may be
    /// divided more often, so that a ray hits the object.
    int edge_levels = 8;
    /// A quadtree cell is divided if the contrast between the samples at its corners exceeds this value in a
    /// colour channel. With the channel's least value min and greatest value max, the contrast is (max - min)
    /// / (max + min + 0.05).
    double threshold = 0.1;
    int colour_levels = 8;  ///< greatest depth to which colour contrast subdivides
};

/// The pixels to sample: columns x_begin to x_end - 1 and rows y_begin to y_end - 1.
/// Samples lie at pixel corners, so there are also samples at x_end and y_end.
struct SampledWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Traces the window in bands of rows. Passes the records of a few rows at a time to `take`, from top to
/// bottom, while the next rows are traced. Calls of `take` are made one at a time, by any thread. A cell is
/// divided in any of these cases:
/// - Its corners show different objects, or different parts of an object (down to `edge_levels`).
/// - The outline of another part of a mesh crosses the cell in front of its corners (down to `edge_levels`).
/// - Colours at its corners or the texture between them have a contrast above `threshold` (`colour_levels`).
/// - Its corners are shadowed from different lights (down to `colour_levels`).
/// - It is a pixel beside a divided pixel in its row, and its centre differs from its corners.
/// - A narrow object in `things` may lie in it (down to `levels`).
///
/// The criteria of objects, contrast and shadows also apply to every hidden layer.
///
/// Needs memory for one band only. The result does not depend on the number of threads.
/// The records of a row are the same in all windows that contain the row above it.
/// Means over lobes (lobe_means.h) are an exception.
/// Returns the number of rays.
RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things = {});

}  // namespace postlens
