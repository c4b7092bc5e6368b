// An upper bound of the error that arises if no rays replace the view samples that the records do not
// determine.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

/// Largest mean squared error of the sum of two errors (Minkowski's inequality).
[[nodiscard]] inline double together_mse(double a, double b) {
    return a + b + 2 * std::sqrt(a * b);
}

/// One value per pixel of the whole image; with a crop, only its pixels are valid.
struct RecordsBound {
    std::vector<float> unsure;  ///< share of view samples that the records do not determine
    std::vector<float> mse;     ///< bound of the squared error of sRGB values, mean over channels
    /// Means over the image or its crop.
    [[nodiscard]] double unsure_share(int width, const std::optional<Crop>& crop) const;
    [[nodiscard]] double mean_mse(int width, const std::optional<Crop>& crop) const;
};

/// Bounds the error that unsure view samples cause, those that the records do not determine
/// (docs/light_field.md). A few views are drawn to find the share of unsure samples in each pixel. The
/// radiance of an unsure sample is assumed to lie between the darkest and the brightest value of the pinhole
/// image within the pixel's largest circle of confusion, and all unsure samples of a pixel are assumed to err
/// in the same direction.
///
/// The bound is mostly far above the error. The error can exceed the bound where the image shows radiance
/// that the pinhole image does not contain. `image`: scene-linear. `lens.scene` and the number of views are
/// ignored. Throws what hybrid_picture throws.
[[nodiscard]] RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image);

}  // namespace postlens
