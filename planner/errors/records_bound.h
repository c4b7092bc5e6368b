// Upper bound of the error of an image that is made from a sample file alone, without tracing rays. Some
// colours are not determined by the file, for instance at edges and where a surface is not recorded. The
// bound assumes the worst colours there.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

/// Returns the largest mean squared value that the sum of two errors can have, if the mean squares of the
/// errors are `a` and `b` (Minkowski's inequality).
[[nodiscard]] inline double together_mse(double a, double b) {
    return a + b + 2 * std::sqrt(a * b);
}

/// Largest error that unsure samples can cause in each pixel. A sample is what one view (image from one lens
/// point) sees in the pixel. It is unsure if the sample file does not determine its colour, for example near
/// an edge. Outside the crop, the values are not valid.
struct RecordsBound {
    std::vector<float> unsure;  ///< share of the unsure samples
    std::vector<float> mse;     ///< bound of the squared error of sRGB values, mean over channels
};

/// Returns an upper bound of each pixel's error due to unsure samples. A sample is a pixel of one view (image
/// from one lens point). It is unsure at an edge, or where no surface is recorded. `image` is scene-linear.
/// `lens.scene` and the number of views are ignored. Throws the errors of hybrid_picture.
///
/// The bound assumes that the radiance of an unsure sample occurs in the pinhole image within the largest
/// circle of confusion. It also assumes that all unsure samples of a pixel are too bright, or all too dark.
/// It is usually much larger than the error.
[[nodiscard]] RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image);

}  // namespace postlens
