// Upper bound of the error that arises if the records do not determine some view samples and no rays replace
// these samples.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

/// Largest possible mean squared error of the sum of two errors (Minkowski's inequality).
[[nodiscard]] inline double together_mse(double a, double b) {
    return a + b + 2 * std::sqrt(a * b);
}

/// One value per pixel of the whole image. With a crop, only the values of its pixels are valid.
struct RecordsBound {
    std::vector<float> unsure;  ///< share of view samples that the records do not determine
    std::vector<float> mse;     ///< bound of the squared error of sRGB values, mean over channels
};

/// Bounds the error that unsure view samples cause. These are the samples that the records do not determine
/// (docs/light_field.md). A few views are drawn to measure the share of unsure samples in each pixel. The
/// bound assumes that the radiance of an unsure sample lies between the darkest and the brightest value of
/// the pinhole image within the pixel's largest circle of confusion. It also assumes that all unsure samples
/// of a pixel err in the same direction.
///
/// The bound is usually much larger than the error. The error can exceed the bound where the image contains
/// radiance that the pinhole image does not contain. `image`: scene-linear. `lens.scene` and the number of
/// views are ignored. Throws the errors of hybrid_picture.
[[nodiscard]] RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image);

}  // namespace postlens
