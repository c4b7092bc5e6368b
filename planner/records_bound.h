// An upper bound of the error that unsure view samples cause where no rays replace them.
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
    std::vector<float> unsure;  ///< share of unsure view samples
    std::vector<float> mse;     ///< bound of the squared error of sRGB values, mean over channels
    /// Means over the image or its crop.
    [[nodiscard]] double unsure_share(int width, const std::optional<Crop>& crop) const;
    [[nodiscard]] double mean_mse(int width, const std::optional<Crop>& crop) const;
};

/// A few views find the share of unsure samples (docs/light_field.md). An unsure sample is assumed to have
/// any radiance between the darkest and the brightest of the pinhole image within the largest CoC of the
/// pixel, and all of them are assumed to err in the same direction. The bound is mostly far above the error;
/// radiance that the pinhole image does not contain can exceed it. `image`: scene-linear. `lens.scene` and
/// the number of views are ignored. Throws what hybrid_picture throws.
[[nodiscard]] RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image);

}  // namespace postlens
