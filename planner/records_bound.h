// How far a picture may be off by what its records are not sure of, where no ray looks.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "planner/hybrid.h"

namespace postlens {

/// Of two errors that may go in one direction, at most (Minkowski's inequality).
[[nodiscard]] inline double together_mse(double a, double b) {
    return a + b + 2 * std::sqrt(a * b);
}

/// By pixel of the whole picture; of a crop only its pixels say anything.
struct RecordsBound {
    std::vector<float> unsure;  ///< share of the view samples that the records are not sure of
    std::vector<float> mse;     ///< squared error of encoded values, mean of the channels, at most
    /// Means of the picture or its crop.
    [[nodiscard]] double unsure_share(int width, const std::optional<Crop>& crop) const;
    [[nodiscard]] double mean_mse(int width, const std::optional<Crop>& crop) const;
};

/// What is unsure is told by a few views, as they would be left to rays (docs/light_field.md); such samples
/// may show anything between the darkest and the brightest that the pinhole sees as far around the pixel as
/// the lens blurs anything. All of them may be wrong in one direction: a bound, mostly far from what
/// the error is; only what the pinhole sees nothing like can be worse. `image`: the picture, scene-linear;
/// the scene and the views of `lens` do not count. Throws what hybrid_picture throws.
[[nodiscard]] RecordsBound records_bound(FocusFrame& frame, const HybridSettings& lens, const Image& image);

}  // namespace postlens
