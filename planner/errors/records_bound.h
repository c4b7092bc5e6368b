// Upper bound of the error of an image that is made from a sample file without rays. The error arises in
// pixels whose colours the file's records do not determine.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

/// Returns the largest possible mean squared error of the sum of two errors (Minkowski's inequality).
[[nodiscard]] inline double together_mse(double a, double b) {
    return a + b + 2 * std::sqrt(a * b);
}

/// Upper bound of the error of each pixel that is due to unsure samples. A sample is what one view (image
/// from one lens point) sees in the pixel. It is unsure if it lies at an edge, or if no surface is recorded
/// there. The values are valid only within the crop.
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
