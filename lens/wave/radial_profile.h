// Encircled energy over the radius in pixels, mixed from several wavelengths.
#pragma once

#include <vector>

#include "lens/wave/radial_energy.h"

namespace postlens {

/// The sum of the responses of some wavelengths, each with its weight, around a centre.
class RadialProfile {
  public:
    struct Part {
        const RadialEnergy* energy = nullptr;  ///< must outlive the profile
        double v_per_px = 0;
        double weight = 1;
    };
    explicit RadialProfile(std::vector<Part> parts) : parts_(std::move(parts)) {}

    /// Up to where every part's table reaches, px.
    [[nodiscard]] double end_px() const;
    /// The most of v to a pixel.
    [[nodiscard]] double v_per_px() const;

    /// Share of the energy within the radius, 0 to end_px().
    [[nodiscard]] double within(double radius_px) const;
    /// `within` without what is finer than `width_px`: exact to the fourth order where it is smooth, means
    /// over the width where fringes are finer. The radius must keep 3/2 widths from 0 and from the end.
    [[nodiscard]] double smoothed_within(double radius_px, double width_px) const;
    /// The same for `count` radii from `begin_px` on, `row_steps` to a width: each integral that a mean needs
    /// serves four of them.
    static constexpr int row_steps = 6;
    [[nodiscard]] std::vector<double> smoothed_row(double begin_px, double width_px, std::size_t count) const;
    /// Energy per square pixel at the radius, from the closed form of each part.
    [[nodiscard]] double density(double radius_px) const;

  private:
    std::vector<Part> parts_;
};

}  // namespace postlens
