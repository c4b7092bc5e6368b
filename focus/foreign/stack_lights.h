// Converts the samples of an image from another program to light that can be blurred (PixelLight). A pixel
// may have several samples, one behind another. The light that nearer samples hide is kept separately,
// because other lens points than the pinhole may see it.
#pragma once

#include <span>
#include <vector>

#include "focus/foreign/behind_fill.h"
#include "focus/scatter/pixel_light.h"
#include "lens/focus_geometry.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Which value of a sample is blurred. To blur alpha, it is copied to red, green and blue, so that it can be
/// blurred by the same functions as a colour.
enum class StackValue { colour, alpha };

/// Converts the samples of a pixel to light that can be blurred. Samples with similar signed CoC radii form
/// one surface, because they are blurred almost equally. The light of each surface has two parts: the light
/// that the pinhole sees, and the light that nearer samples hide from the pinhole.
class StackLights {
  public:
    /// Set `with_nothing` if empty space behind the samples should take part in the compositing. It is then
    /// added as a sharp surface at infinity without colour and alpha, so the blurred edges of objects in
    /// front of it are translucent. Otherwise, empty space is ignored.
    StackLights(const FocusGeometry& geometry, bool with_nothing)
        : geometry_(geometry), with_nothing_(with_nothing) {}

    /// Appends the light of one pixel to `out`.
    /// - `x`: column of the pixel
    /// - `stack`: the samples of the pixel, from the nearest to the farthest
    /// - `fills`: whether the farthest sample counts as opaque even if its alpha is below 1
    /// - `open`: fraction of light that all samples of the pixel together transmit
    /// - `behind`: the estimated surface that these samples hide, or null
    /// - `value`: whether the colour of the samples is blurred, or their alpha
    void add(int x, std::span<const StackSample> stack, bool fills, double open, const Behind* behind,
             StackValue value, std::vector<PixelLight>& out);

    /// Returns a number for a signed CoC radius. Samples of one pixel with equal numbers are merged to one
    /// surface, because they are blurred almost equally. Radii with equal numbers differ by less than about 1
    /// px, or by less than about 1/16 of the radius if it is large.
    [[nodiscard]] static std::uint32_t surface_of(double signed_radius_px);
    static constexpr std::uint32_t nothing = ~std::uint32_t{0};

  private:
    struct Met {
        std::uint32_t surface;
        double radius_px, seen;
    };
    /// Two inverse depths of a sample, in 1/m. They differ only if an effect changes the blur of the sample's
    /// object, for example "keep this object sharp".
    /// - `order`: depth that decides which samples hide it
    /// - `spread`: depth that decides how large its circle of confusion is
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
