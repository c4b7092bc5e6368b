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
    /// The encircled energy, which is the fraction of the energy within the optical radius v, is tabulated at
    /// equal steps of v. Returns this step for the defocus `u`: 1/8 for |u| < 256, and otherwise 1/2. u and v
    /// are in optical units [born1999, 8.8.1].
    [[nodiscard]] static double step_for(double u);
    /// Returns how many entries a BesselGrid must have to compute the encircled energy for all optical radii
    /// up to v_end. A BesselGrid is a table of Bessel functions at the optical radii 0, `step`, 2 `step`, and
    /// so on.
    [[nodiscard]] static std::size_t grid_count(double step, double v_end);

    /// Computes the encircled energy at the defocus `u`: the fraction of the energy within each optical
    /// radius v from 0 to v_end, both in optical units (lommel.h). `grid` is a table of Bessel functions. Its
    /// step must be `step_for(u)`, and it must have at least `grid_count(step_for(u), v_end)` entries.
    RadialEnergy(double u, double v_end, const BesselGrid& grid);

    /// Computes the same, but makes the required table of Bessel functions itself.
    RadialEnergy(double u, double v_end);

    [[nodiscard]] double u() const { return u_; }
    [[nodiscard]] double v_end() const { return step_ * static_cast<double>(within_.size() - 1); }

    /// Returns the encircled energy: the fraction of a point's light that lands within the optical radius v
    /// (lommel.h) from the centre of its impulse response. v must not exceed v_end(). The error is below
    /// 2e-7.
    [[nodiscard]] double within(double v) const;
    /// Returns the integral of the encircled energy, within(), over the optical radius from 0 to v. The mean
    /// encircled energy from v1 to v2 is (within_integral(v2) - within_integral(v1)) / (v2 - v1). In this
    /// mean, narrow diffraction fringes average out.
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
