// Converts a pixel's stack of samples to PixelLight, separated into the light that the pinhole sees and
// hidden light.
#pragma once

#include <span>
#include <vector>

#include "focus/foreign/behind_fill.h"
#include "focus/scatter/pixel_light.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Which values become light: the colours, or the alphas (in all three channels).
enum class StackValue { colour, alpha };

/// Converts stacks one after the other.
///
/// A sample behind samples of transmittance T (the product of their 1 - alpha) is seen with the share T alpha
/// and hidden with (1 - T) alpha; its premultiplied colour is divided in the same ratio. Empty space at
/// infinity fills the rest of a pixel, and continues behind translucent samples, so the seen shares of a
/// pixel add up to 1. Samples whose signed CoC radii differ by less than a pixel (beyond 16 px by less than a
/// 16th) move together over the lens and form one surface.
class StackLights {
  public:
    /// `with_nothing`: also makes light of empty space, which is not blurred.
    StackLights(const FocusGeometry& geometry, bool with_nothing)
        : geometry_(geometry), with_nothing_(with_nothing) {}

    /// Converts a stack and appends to `out`. `behind`: estimate of the surface behind the stack, may be
    /// null. `fills`: the last sample is a uniformly translucent surface that fills the pixel, so the stack's
    /// weights add up to 1 as those of an opaque one. Only for pixels that, like their neighbours, have only
    /// empty space behind them.
    void add(int x, std::span<const StackSample> stack, bool fills, const Behind* behind, StackValue value,
             std::vector<PixelLight>& out);

    /// Number of the surface for a signed CoC radius.
    [[nodiscard]] static std::uint32_t surface_of(double signed_radius_px);
    static constexpr std::uint32_t nothing = ~std::uint32_t{0};

  private:
    struct Met {
        std::uint32_t surface;
        double radius_px, seen;
    };
    /// Inverse depths, 1/m: of the order of compositing, and of the circle of confusion.
    struct Depths {
        double order = 0, spread = 0;
    };
    void add_surface(std::uint32_t surface, const Depths& depths, const std::array<double, 3>& rgb,
                     double alpha, bool behind_all);
    [[nodiscard]] std::uint32_t surface_at(double inverse_depth) const {
        return surface_of(geometry_.coc_diameter_px(inverse_depth) / 2);
    }

    struct Sum {
        std::uint32_t surface = 0;
        std::array<double, 3> seen{}, hidden{};
        double seen_weight = 0, hidden_weight = 0, covered = 0;
        Depths seen_depths, hidden_depths;  ///< times the weights
    };
    FocusGeometry geometry_;
    bool with_nothing_;
    double left_ = 1;  ///< transmittance of the samples so far
    std::vector<Met> met_;
    std::vector<Sum> sums_;
};

}  // namespace postlens
