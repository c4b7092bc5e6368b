#include "lens/lommel/radial_energy.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "lens/lommel/lommel_rows.h"

namespace postlens {
namespace {

/// Weights that integrate dE/dv over one step, from the eight nearest values. They are exact for the
/// polynomial through these values. They are symmetric, so only four are stored.
constexpr std::array<double, 4> middle_weights = {68323.0 / 120960, -9531.0 / 120960, 1879.0 / 120960,
                                                  -191.0 / 120960};
constexpr std::size_t values_beyond = 3;  ///< values used beyond each end of a step

}  // namespace

double RadialEnergy::step_for(double u) {
    // At small defocus |u|, a few fringes contain all of the energy, so the steps must be fine. At large |u|,
    // each fringe contains at most 1/u of the energy, so coarser steps suffice.
    return std::abs(u) < 256 ? 0.125 : 0.5;
}

std::size_t RadialEnergy::grid_count(double step, double v_end) {
    return static_cast<std::size_t>(std::ceil(v_end / step)) + 2 + values_beyond;
}

RadialEnergy::RadialEnergy(double u, double v_end)
    : RadialEnergy(u, v_end, BesselGrid(step_for(u), grid_count(step_for(u), v_end))) {}

RadialEnergy::RadialEnergy(double u, double v_end, const BesselGrid& grid) : u_(u), step_(grid.step) {
    const std::size_t count = grid_count(step_, v_end);
    assert(grid.step == step_for(u) && grid.j0.size() >= count);
    intensity_.resize(count);
    lommel_row(u, grid, intensity_);
    const std::size_t nodes = count - values_beyond;
    within_.resize(nodes);
    within_sum_.resize(nodes);
    // dE/dv = I v / 2 is an odd function of v, so its values at negative v follow by symmetry.
    const auto slope = [this](std::ptrdiff_t i) {
        const double v = step_ * static_cast<double>(i);
        return intensity_[static_cast<std::size_t>(std::abs(i))] * v / 2;
    };
    for (std::size_t i = 0; i + 1 < nodes; ++i) {
        const auto k = static_cast<std::ptrdiff_t>(i);
        double sum = 0;
        for (std::ptrdiff_t m = 0; m < 4; ++m) {
            sum += middle_weights[static_cast<std::size_t>(m)] * (slope(k - m) + slope(k + 1 + m));
        }
        within_[i + 1] = within_[i] + step_ * sum;
        // Integral, over the step, of the cubic Hermite polynomial with the known values and slopes at both
        // ends.
        within_sum_[i + 1] = within_sum_[i] + step_ * (within_[i] + within_[i + 1]) / 2 +
                             step_ * step_ * (slope(k) - slope(k + 1)) / 12;
    }
}

double RadialEnergy::within(double v) const {
    const double at = v / step_;
    const auto i = std::min(static_cast<std::size_t>(at), within_.size() - 2);
    const double t = at - static_cast<double>(i), r = 1 - t;
    const double slope0 = intensity_[i] * static_cast<double>(i) / 2 * step_ * step_;
    const double slope1 = intensity_[i + 1] * static_cast<double>(i + 1) / 2 * step_ * step_;
    return r * r * ((1 + 2 * t) * within_[i] + t * slope0) +
           t * t * ((3 - 2 * t) * within_[i + 1] - r * slope1);
}

double RadialEnergy::within_integral(double v) const {
    const double at = v / step_;
    const auto i = std::min(static_cast<std::size_t>(at), within_.size() - 2);
    const double t = at - static_cast<double>(i);
    const double slope0 = intensity_[i] * static_cast<double>(i) / 2 * step_ * step_;
    const double slope1 = intensity_[i + 1] * static_cast<double>(i + 1) / 2 * step_ * step_;
    const double rise = within_[i + 1] - within_[i];
    // Along the step, t runs from 0 to 1. `within` is interpolated by the cubic Hermite polynomial w0 + s0 t
    // + (3 r - 2 s0 - s1) t^2 + (s0 + s1 - 2 r) t^3. w0 is its value at t = 0, s0 is slope0, s1 is slope1 and
    // r is `rise`. The result contains the integral of this polynomial from 0 to t.
    return within_sum_[i] + step_ * t *
                                (within_[i] + t * (slope0 / 2 + t * ((3 * rise - 2 * slope0 - slope1) / 3 +
                                                                     t * (slope0 + slope1 - 2 * rise) / 4)));
}

}  // namespace postlens
