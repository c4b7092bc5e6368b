// Converts the samples of an image from another program to light that can be blurred (PixelLight). The light
// that the pinhole sees is separated from the light that nearer samples hide from the pinhole, because other
// lens points may see it.
#pragma once

#include <span>
#include <vector>

#include "focus/foreign/behind_fill.h"
#include "focus/scatter/pixel_light.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Which value of a sample is blurred like a colour: its colour, or its alpha in all three channels.
enum class StackValue { colour, alpha };

/// Converts the samples of a pixel, which lie one behind another, to light that can be blurred. The light of
/// each surface has two parts: light that the pinhole sees, and light that nearer samples hide from the
/// pinhole but not from all lens points. Samples with similar signed CoC radii form one surface.
class StackLights {
  public:
    /// If `with_nothing` is true, empty space behind the samples is added as a sharp black surface at
    /// infinity. Otherwise, empty space is ignored.
    StackLights(const FocusGeometry& geometry, bool with_nothing)
        : geometry_(geometry), with_nothing_(with_nothing) {}

    /// Appends the light of one pixel to `out`.
    /// - `x`: column of the pixel
    /// - `stack`: the samples of the pixel, from the nearest to the farthest
    /// - `fills`: whether the last (farthest) sample counts as opaque even if its alpha is below 1
    /// - `open`: fraction of light that all samples of the pixel together transmit
    /// - `behind`: the estimated surface behind the samples, or null
    /// - `value`: what is blurred, colour or alpha
    void add(int x, std::span<const StackSample> stack, bool fills, double open, const Behind* behind,
             StackValue value, std::vector<PixelLight>& out);

    /// Returns the number of the surface to which samples with this signed CoC radius belong. Samples of one
    /// pixel are merged to one surface if they are blurred nearly equally. So radii within about 1 px of each
    /// other have the same number; for large radii, the limit is 1/16 of the radius.
    [[nodiscard]] static std::uint32_t surface_of(double signed_radius_px);
    static constexpr std::uint32_t nothing = ~std::uint32_t{0};

  private:
    struct Met {
        std::uint32_t surface;
        double radius_px, seen;
    };
    /// Two inverse depths of a sample, in 1/m.
    /// - `order`: depth that decides which samples hide it
    /// - `spread`: depth that decides how large its circle of confusion is
    ///
    /// They differ only if an effect changes the blur of the sample's object, for example "keep this object
    /// sharp". The effect does not change which objects hide it.
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
        double left = 1;  ///< transmittance of the surface's samples so far
        std::array<double, 3> seen{}, hidden{};
        double seen_weight = 0, hidden_weight = 0, covered = 0;
        Depths seen_depths, hidden_depths;  ///< depths multiplied by the weights
    };
    FocusGeometry geometry_;
    bool with_nothing_;
    double left_ = 1;  ///< transmittance of all samples so far
    std::vector<Met> met_;
    std::vector<Sum> sums_;
};

}  // namespace postlens
