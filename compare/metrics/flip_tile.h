// LDR-FLIP of two images, tile by tile, at one or several exposures. Used by flip.cpp only.
#pragma once

#include <vector>

#include "compare/metrics/flip.h"
#include "compare/metrics/separable.h"

namespace postlens {

/// The filters of [andersson2020, sec. 4.1.1 and 4.2], separated into factors along rows and columns. All
/// have 2 radius + 1 taps, as many as the widest one needs.
struct FlipFilters {
    int radius = 0;
    /// Filters of contrast sensitivity. The blue-yellow filter is a sum of two Gaussians, and the taps of
    /// each sum to the share of that Gaussian in the filter. The taps of the other filters sum to 1.
    Plane achromatic, red_green;
    Plane blue_yellow_1_row, blue_yellow_1_column, blue_yellow_2_row, blue_yellow_2_column;
    /// A Gaussian with its first and second derivative. The positive taps of a derivative sum to 1, the
    /// negative ones to -1.
    Plane gauss, edge, point;
    explicit FlipFilters(double pixels_per_degree);
};

/// Maps linear values to displayed values within 0..1.
class FlipDisplay {
  public:
    /// Only clamps the values.
    FlipDisplay() = default;
    /// Multiplies the values by 2^stops and applies the tone curve of HDR-FLIP.
    static FlipDisplay at_exposure(double stops);
    [[nodiscard]] float operator()(float linear) const {
        const float x = scale_ * (linear > 0 ? linear : 0.0F);
        const float v = (x * (n2_ * x + n1_)) / (x * (d2_ * x + d1_) + d0_);
        // Very bright values overflow and make v NaN, which becomes white here as well.
        return v < 1 ? v : 1.0F;
    }

  private:
    float scale_ = 1;
    // Tone curve x (n2 x + n1) / (x (d2 x + d1) + d0). The defaults give x.
    float n2_ = 0, n1_ = 1, d2_ = 0, d1_ = 0, d0_ = 1;
};

/// Argument at which the tone curve has the value `level`, 0 < level < 1.
[[nodiscard]] double flip_tone_curve_inverse(double level);

/// Fills `map` with the errors per pixel, each the greatest over `displays` (one or more).
void flip_errors(const Image& reference, const Image& test, const PixelMask& usable,
                 const std::vector<FlipDisplay>& displays, std::vector<float>& map);

}  // namespace postlens
