// A table of an impulse response's energy within each radius, for one wavelength.
#pragma once

#include <span>
#include <vector>

#include "lens/lommel/bessel.h"

namespace postlens {

/// Impulse response of a circular aperture with diffraction, for radii v in [0, v_end]. Radius v and defocus
/// u are the optical coordinates of lommel.h [born1999, 8.8.1]. The total energy is 1.
class RadialEnergy {
  public:
    /// Returns the step of the optical radius v at which the encircled energy, the energy within v, is
    /// tabulated. For a defocus |u| < 256, the step is 1/8. Otherwise, it is 1/2. u and v are in optical
    /// units [born1999, 8.8.1].
    [[nodiscard]] static double step_for(double u);
    /// Returns how many entries a BesselGrid with this step needs for energies up to the optical radius
    /// v_end.
    [[nodiscard]] static std::size_t grid_count(double step, double v_end);

    /// Computes the encircled energy, the fraction of the energy within each optical radius v, up to v_end. u
    /// is the defocus. Both are in optical units (lommel.h). `grid` holds Bessel functions at equal steps of
    /// v. The step must be `step_for(u)`, and `grid` must have at least `grid_count(step_for(u), v_end)`
    /// entries.
    RadialEnergy(double u, double v_end, const BesselGrid& grid);

    /// Computes the same, but makes the required tables of Bessel functions itself.
    RadialEnergy(double u, double v_end);

    [[nodiscard]] double u() const { return u_; }
    [[nodiscard]] double v_end() const { return step_ * static_cast<double>(within_.size() - 1); }

    /// Returns the fraction of the point's light within the optical radius v <= v_end. The error is below
    /// 2e-7.
    [[nodiscard]] double within(double v) const;
    /// Returns the integral of the encircled energy within(v') over the optical radius v', from 0 to v. The
    /// difference of two such integrals, divided by the width of the interval between them, is the mean
    /// encircled energy in this interval. In this mean, narrow diffraction fringes average out.
    [[nodiscard]] double within_integral(double v) const;
    /// Returns the diffraction pattern's intensity at the optical radii v = 0, step(), 2 step(), ..., as a
    /// fraction of the peak intensity in focus.
    [[nodiscard]] std::span<const double> intensity() const { return intensity_; }
    [[nodiscard]] double step() const { return step_; }

  private:
    double u_ = 0, step_ = 0.5;
    std::vector<double> intensity_;   ///< I(u, i step)
    std::vector<double> within_;      ///< fraction of the energy within v = i step
    std::vector<double> within_sum_;  ///< integral of within_ from 0
};

}  // namespace postlens
