#include "lens/lommel/radial_energy.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "lens/lommel/lommel_rows.h"

namespace postlens {
namespace {

/// Weights that integrate a tabulated function over one step of the table. They use the eight nearest entries
/// and are exact for the polynomial through these. The weights are symmetric about the middle of the step, so
/// only four are stored.
constexpr std::array<double, 4> middle_weights = {68323.0 / 120960, -9531.0 / 120960, 1879.0 / 120960,
                                                  -191.0 / 120960};
constexpr std::size_t values_beyond = 3;  ///< values used beyond each end of a step

}  // namespace

double RadialEnergy::step_for(double u) {
    // The energy within each optical radius is tabulated in steps that must resolve diffraction fringes. If
    // the defocus |u| is small, a few fringes hold all energy, so the steps must be fine. If |u| is large,
    // each fringe holds little energy, so coarse steps suffice.
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
    // Returns the slope dE/dv of the encircled energy E at table entry i. With the intensity I at the optical
    // radius v, it is I v / 2. Near the centre, i and v may be negative, but the intensity is the same at v
    // and -v.
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
    // Adds the integral of the encircled energy over the fraction t of step i to its integral up to the start
    // of this step. Within the step, a cubic Hermite polynomial approximates the energy. It begins at w0 =
    // within_[i], rises by `rise`, and has the slopes slope0 and slope1 (per step) at the ends:
    //
    //     w0 + slope0 t + (3 rise - 2 slope0 - slope1) t^2 + (slope0 + slope1 - 2 rise) t^3
    return within_sum_[i] + step_ * t *
                                (within_[i] + t * (slope0 / 2 + t * ((3 * rise - 2 * slope0 - slope1) / 3 +
                                                                     t * (slope0 + slope1 - 2 * rise) / 4)));
}

}  // namespace postlens
