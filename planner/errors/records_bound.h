// Upper bound of the error of an image without rays. The error is caused by unsure view samples, whose
// colours the records do not determine.
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

/// Values for all pixels of the image. With a crop, only those of the pixels within the crop are valid.
struct RecordsBound {
    std::vector<float> unsure;  ///< share of view samples that the records do not determine
    std::vector<float> mse;     ///< bound of the squared error of sRGB values, mean over channels
};

/// Returns an upper bound of the error that unsure view samples cause. Unsure samples are those that the
/// records do not determine (docs/light_field.md). A few views are drawn to measure their share in each
/// pixel.
///
/// The bound is based on two assumptions. The radiance of an unsure sample lies between the darkest and the
/// brightest value of the pinhole image within the pixel's largest circle of confusion. All unsure samples of
/// a pixel are too bright, or all are too dark. The bound is usually much larger than the error. The error
/// can exceed the bound if the pinhole image does not contain all radiance of the scene.
///
/// `image` is scene-linear. `lens.scene` and the number of views are ignored. Throws the errors of
/// hybrid_picture.
[[nodiscard]] RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image);

}  // namespace postlens
