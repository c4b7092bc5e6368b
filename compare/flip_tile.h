// LDR-FLIP of one tile of two pictures, at one exposure or at several. Used by flip.cpp only.
#pragma once

#include <vector>

#include "compare/flip.h"
#include "compare/separable.h"

namespace postlens {

/// The filters [andersson2020, sec. 4.1.1 and 4.2], split into their factors along rows and columns; all with
/// 2 radius + 1 taps, the widest one's number.
struct FlipFilters {
    int radius = 0;
    /// Contrast sensitivity. The blue-yellow filter is a sum of two Gaussians, which sum to their shares.
    Plane achromatic, red_green;
    Plane blue_yellow_1_row, blue_yellow_1_column, blue_yellow_2_row, blue_yellow_2_column;
    /// A Gaussian, its first and its second derivative. Of the derivatives the positive taps sum to 1, the
    /// negative ones to -1.
    Plane gauss, edge, point;
    explicit FlipFilters(double pixels_per_degree);
};

/// How linear values become those that are shown, all within 0..1.
class FlipDisplay {
  public:
    /// Clamped, nothing else.
    FlipDisplay() = default;
    /// Multiplied by 2^stops, then through the tone curve of HDR-FLIP.
    static FlipDisplay at_exposure(double stops);
    [[nodiscard]] float operator()(float linear) const {
        const float x = scale_ * (linear > 0 ? linear : 0.0F);
        const float v = (x * (n2_ * x + n1_)) / (x * (d2_ * x + d1_) + d0_);
        // So bright that it is beyond float: white, as the clamp makes of everything near it.
        return v < 1 ? v : 1.0F;
    }

  private:
    float scale_ = 1;
    // x (n2 x + n1) / (x (d2 x + d1) + d0); without a tone curve x / 1.
    float n2_ = 0, n1_ = 1, d2_ = 0, d1_ = 0, d0_ = 1;
};

/// The argument that the tone curve takes to `level`, 0 < level < 1.
[[nodiscard]] double flip_tone_curve_inverse(double level);

/// Fills `map` with the greatest error over `displays` (one or more).
void flip_errors(const Image& reference, const Image& test, const PixelMask& usable,
                 const std::vector<FlipDisplay>& displays, std::vector<float>& map);

}  // namespace postlens
