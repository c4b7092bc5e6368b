// A pixel's stack of samples as light for the tables: what of it the pinhole sees, and what it hides.
#pragma once

#include <span>
#include <vector>

#include "focus/behind_fill.h"
#include "focus/pixel_light.h"
#include "lens/focus_geometry.h"
#include "records/foreign_picture.h"

namespace postlens {

/// What is to be counted as light: the colours, or the alphas (in all three channels).
enum class StackValue { colour, alpha };

/// Turns stacks into light, one after the other; keeps its buffers.
///
/// Of a sample behind others of transparency T (the product of 1 - alpha before it) the share T alpha is seen
/// and (1 - T) alpha hidden; its premultiplied colour is divided likewise. Nothing, infinitely far, fills
/// what is left of a pixel and goes on behind what is translucent. So the lights of a pixel that are seen
/// fill it exactly. Samples of similar circles are one surface, since they move together over the lens:
/// within a pixel of signed radius, or a 16th of it beyond 16 px.
class StackLights {
  public:
    /// `with_nothing`: what is nothing is among the lights as well, and is spread by no circle.
    StackLights(const FocusGeometry& geometry, bool with_nothing)
        : geometry_(geometry), with_nothing_(with_nothing) {}

    /// Appends to `out`. `behind` may be null. `fills`: before nothing the last sample of a stack is a
    /// surface that fills its pixel and is seen through evenly, so that its circles add up to one wherever
    /// they do for an opaque one; what shines through it from behind must be nothing everywhere around.
    void add(int x, std::span<const StackSample> stack, bool fills, const Behind* behind, StackValue value,
             std::vector<PixelLight>& out);

    /// The surface that something of this signed radius belongs to.
    [[nodiscard]] static std::uint32_t surface_of(double signed_radius_px);
    static constexpr std::uint32_t nothing = ~std::uint32_t{0};

  private:
    struct Met {
        std::uint32_t surface;
        double radius_px, seen;
    };
    void add_surface(std::uint32_t surface, double inverse_depth, const std::array<double, 3>& rgb,
                     double alpha, bool behind_all);

    struct Sum {
        std::uint32_t surface = 0;
        std::array<double, 3> seen{}, hidden{};
        double seen_weight = 0, hidden_weight = 0, covered = 0, seen_depth = 0, hidden_depth = 0;
    };
    FocusGeometry geometry_;
    bool with_nothing_;
    double left_ = 1;  ///< transparency so far
    std::vector<Met> met_;
    std::vector<Sum> sums_;
};

}  // namespace postlens
