// Table of how the response's energy at one wavelength is distributed over the radius.
#pragma once

#include <span>
#include <vector>

#include "lens/lommel/bessel.h"

namespace postlens {

/// The response of a circular aperture with defocus u, tabulated over v in [0, v_end]. The steps resolve
/// every fringe, because I(u, v) contains no frequency above 2 (the aperture ends at p = 1). Intensity and
/// energy are related by dE = I v dv / 2: the intensity is 1 at (u, v) = (0, 0), and the total energy through
/// the aperture is 1.
class RadialEnergy {
  public:
    /// Step of v in the table for u: 1/8 or 1/2.
    [[nodiscard]] static double step_for(double u);
    /// Number of grid entries that a table up to v_end needs.
    [[nodiscard]] static std::size_t grid_count(double step, double v_end);

    /// `grid` must have the step `step_for(u)`, and at least `grid_count` entries for this v_end.
    RadialEnergy(double u, double v_end, const BesselGrid& grid);

    /// Makes its own tables of Bessel functions.
    RadialEnergy(double u, double v_end);

    [[nodiscard]] double u() const { return u_; }
    [[nodiscard]] double v_end() const { return step_ * static_cast<double>(within_.size() - 1); }

    /// Share of the energy within radius v, for 0 <= v <= v_end. The error is below 2e-7.
    [[nodiscard]] double within(double v) const;
    /// Integral of `within` from 0 to v. The difference of two values, divided by the difference of their v,
    /// is a mean of `within` that averages out finer fringes.
    [[nodiscard]] double within_integral(double v) const;
    /// I(u, v) at v = i step().
    [[nodiscard]] std::span<const double> intensity() const { return intensity_; }
    [[nodiscard]] double step() const { return step_; }

  private:
    double u_ = 0, step_ = 0.5;
    std::vector<double> intensity_;   ///< I(u, i step)
    std::vector<double> within_;      ///< share of the energy within i step
    std::vector<double> within_sum_;  ///< integral of within_ from 0
};

}  // namespace postlens
