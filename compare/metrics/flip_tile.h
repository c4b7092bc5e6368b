// Computes LDR-FLIP of two images, tile by tile, at one or several exposures.
#pragma once

#include <vector>

#include "compare/metrics/flip.h"
#include "compare/metrics/separable.h"

namespace postlens {

/// Filters with which FLIP compares two images as the eye sees them [andersson2020, sec. 4.1.1 and 4.2]. Each
/// filter is separable: it is the product of a filter along rows and a filter along columns. Each of these
/// has 2 radius + 1 taps (weights).
struct FlipFilters {
    int radius = 0;
    /// Contrast sensitivity filters of the three opponent colour channels, which model how well the eye sees
    /// details. Each filter is separable (rows, then columns). The filter of the blue-yellow channel is a
    /// weighted sum of two Gaussians, 1 and 2, whose weights are multiplied into the column filters. The taps
    /// of every other filter sum to 1.
    TileChannel achromatic, red_green;
    TileChannel blue_yellow_1_row, blue_yellow_1_column, blue_yellow_2_row, blue_yellow_2_column;
    /// Filters that detect edges and points. `gauss` is a Gaussian, `edge` its first derivative and `point`
    /// its second derivative. The positive taps of a derivative sum to 1, and its negative taps sum to -1.
    TileChannel gauss, edge, point;
    explicit FlipFilters(double pixels_per_degree);
};

/// Maps linear values to displayed values within 0..1.
class FlipDisplay {
  public:
    /// Makes a mapping that only clamps values to 0..1.
    FlipDisplay() = default;
    /// Returns the mapping of HDR-FLIP for one exposure: multiplication by 2^stops, then the tone curve.
    static FlipDisplay at_exposure(double stops);
    [[nodiscard]] float operator()(float linear) const {
        const float x = scale_ * (linear > 0 ? linear : 0.0F);
        const float v = (x * (n2_ * x + n1_)) / (x * (d2_ * x + d1_) + d0_);
        // For very bright values, the tone curve overflows: infinity / infinity is a NaN. Then v < 1 is
        // false, and the result is 1 (white).
        return v < 1 ? v : 1.0F;
    }

  private:
    float scale_ = 1;
    // Coefficients of the tone curve x (n2 x + n1) / (x (d2 x + d1) + d0). The defaults give f(x) = x.
    float n2_ = 0, n1_ = 1, d2_ = 0, d1_ = 0, d0_ = 1;
};

/// Returns the x at which the tone curve of HDR-FLIP has the value `level`, which must be in (0, 1).
[[nodiscard]] double flip_tone_curve_inverse(double level);

/// Sets `map` to the FLIP error of each pixel of `test`, compared with `reference`: the largest over all
/// exposures in `displays`, of which there must be at least one.
void flip_errors(const Image& reference, const Image& test, const PixelMask& usable,
                 const std::vector<FlipDisplay>& displays, std::vector<float>& map);

}  // namespace postlens
