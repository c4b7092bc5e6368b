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

    /// Returns the fraction of the impulse response's energy that lies within a radius of its centre. The
    /// radius is in px, from 0 to end_px(), up to which the profile is known.
    [[nodiscard]] double within(double radius_px) const;
    /// Returns the fraction of the energy within a radius, in px, as a smooth function of the radius:
    /// diffraction fringes finer than `width_px` are averaged out. Without fringes, the averaging causes an
    /// error in proportion to width_px^4.
    ///
    /// The radius must be at least 3/2 width_px away from 0 and from end_px(), because the average also uses
    /// radii around it.
    [[nodiscard]] double smoothed_within(double radius_px, double width_px) const;
    /// Returns the fractions of the energy within `count` radii, computed as by smoothed_within():
    /// diffraction fringes finer than `width_px` are averaged out. The first radius is begin_px, and each
    /// next radius is larger by width_px / row_steps. This is faster than single calls of smoothed_within().
    static constexpr int row_steps = 6;
    [[nodiscard]] std::vector<double> smoothed_row(double begin_px, double width_px, std::size_t count) const;
    /// Returns the fraction of the blur kernel's energy per px^2 at a distance from the kernel's centre, by
    /// Lommel's formula for diffraction.
    [[nodiscard]] double density(double radius_px) const;

  private:
    std::vector<Part> parts_;
};

}  // namespace postlens
