// Encircled energy (the energy within a radius) of a mixture of wavelengths.
#pragma once

#include <vector>

#include "lens/lommel/radial_energy.h"

namespace postlens {

/// The weighted sum of the concentric responses of several wavelengths.
class RadialProfile {
  public:
    struct Part {
        const RadialEnergy* energy = nullptr;  ///< must outlive the profile
        double v_per_px = 0;
        double weight = 1;
    };
    explicit RadialProfile(std::vector<Part> parts) : parts_(std::move(parts)) {}

    /// Radius, in px, up to which the profile is known.
    [[nodiscard]] double end_px() const;
    /// Optical radius v per px; the largest of all wavelengths.
    [[nodiscard]] double v_per_px() const;

    /// Returns the fraction of the energy within a radius from 0 to end_px(), in px.
    [[nodiscard]] double within(double radius_px) const;
    /// Returns the energy within a radius, with diffraction fringes finer than `width_px` averaged out. The
    /// error is of fourth order in `width_px`.
    ///
    /// The radius must be at least 3/2 widths from 0 and from end_px().
    [[nodiscard]] double smoothed_within(double radius_px, double width_px) const;
    /// Returns `smoothed_within` at `count` radii, from begin_px on in steps of width_px / row_steps. This is
    /// faster than single calls.
    static constexpr int row_steps = 6;
    [[nodiscard]] std::vector<double> smoothed_row(double begin_px, double width_px, std::size_t count) const;
    /// Returns the energy per px^2 at a radius, from the closed form of the intensity.
    [[nodiscard]] double density(double radius_px) const;

  private:
    std::vector<Part> parts_;
};

}  // namespace postlens
