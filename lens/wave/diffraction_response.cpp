#include "lens/wave/diffraction_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/memory.h"
#include "core/threads.h"
#include "lens/wave/wave_scale.h"

namespace postlens {
namespace {

/// Tables of the Bessel functions J_0 and J_1, at equal steps of the optical radius v. From these tables,
/// diffraction patterns are computed. There is one table for each of the two steps that
/// RadialEnergy::step_for returns.
class BesselGrids {
  public:
    void want(double u, double v_end) {
        const std::size_t i = index(u);
        const double step = RadialEnergy::step_for(u);
        count_[i] = std::max(count_[i], RadialEnergy::grid_count(step, v_end));
        step_[i] = step;
    }
    void make() {
        for (std::size_t i = 0; i < 2; ++i) grids_[i] = BesselGrid(step_[i], count_[i]);
    }
    [[nodiscard]] const BesselGrid& of(double u) const { return grids_[index(u)]; }
    [[nodiscard]] std::size_t longest() const { return std::max(count_[0], count_[1]); }

  private:
    static std::size_t index(double u) {
        return RadialEnergy::step_for(u) == RadialEnergy::step_for(0) ? 0 : 1;
    }
    std::array<double, 2> step_ = {RadialEnergy::step_for(0), RadialEnergy::step_for(1e9)};
    std::array<std::size_t, 2> count_{};
    std::array<BesselGrid, 2> grids_;
};

void check(const FocusGeometry& geometry, std::span<const double> cocs, const DiffractionSettings& s) {
    if (!(geometry.aperture_radius_m > 0) || !(geometry.gain_px > 0) ||
        !std::isfinite(geometry.aperture_radius_m)) {
        fail(ExitCode::wrong_arguments,
             "diffraction needs an aperture of some width (got a radius of {} m and {} px of raster per "
             "radian)",
             geometry.aperture_radius_m, geometry.gain_px);
    }
    if (!(s.tail > 0 && s.tail < 1)) {
        fail(ExitCode::wrong_arguments,
             "tail of the response is out of range (got {}; expected 0 < tail < 1)", s.tail);
    }
    if (!(s.max_radius_px >= 1 && s.max_radius_px <= 16384)) {
        fail(ExitCode::wrong_arguments,
             "radius of the response is out of range (got {} px; expected 1 to 16384 px)", s.max_radius_px);
    }
    for (const double coc : cocs) {
        if (!std::isfinite(coc)) {
            fail(ExitCode::wrong_arguments,
                 "diameter of the circle of confusion is out of range (got {} px; expected a finite number)",
                 coc);
        }
    }
}

/// Sizes that are needed to compute the impulse response of one depth: that of its pixel grid, and the radius
/// up to which its radial profile must be known. They are determined for all depths before memory is
/// allocated.
struct Plan {
    double radius_px = 0;
    ResponseGrid window;  ///< pixels of the response, without values
    double reach_px = 0;
};

Plan plan_of(double coc_px, const std::vector<WaveScale>& scales, const DiffractionSettings& s) {
    Plan plan;
    for (const WaveScale& scale : scales) {
        const double u = scale.v_per_px * coc_px / 2;
        plan.radius_px = std::max(plan.radius_px, radius_of_tail(u, s.tail) / scale.v_per_px);
    }
    plan.radius_px = std::min(plan.radius_px, s.max_radius_px);
    const double x0 = std::floor(s.centre_x - plan.radius_px), x1 = std::ceil(s.centre_x + plan.radius_px);
    const double y0 = std::floor(s.centre_y - plan.radius_px), y1 = std::ceil(s.centre_y + plan.radius_px);
    plan.window.x_begin = static_cast<int>(x0);
    plan.window.y_begin = static_cast<int>(y0);
    plan.window.width = static_cast<int>(x1 - x0);
    plan.window.height = static_cast<int>(y1 - y0);
    plan.reach_px = reach_px(plan.window, s.centre_x, s.centre_y, s.pixels);
    return plan;
}

/// Sets pixels of an impulse response outside a circle around its centre to 0. Otherwise, its square grid of
/// pixels would be visible around bright points.
void cut_to_circle(double centre_x, double centre_y, double radius_px, ResponseGrid& grid) {
    const auto nearest = [](double begin) { return begin > 0 ? begin : begin < -1 ? begin + 1 : 0.0; };
    for (int j = 0; j < grid.height; ++j) {
        const double y = nearest(grid.y_begin + j - centre_y);
        for (int i = 0; i < grid.width; ++i) {
            const double x = nearest(grid.x_begin + i - centre_x);
            if (x * x + y * y > radius_px * radius_px) grid.at(i, j) = 0;
        }
    }
}

}  // namespace

double radius_of_tail(double u, double tail) {
    // Returns the radius v beyond which the fraction `tail` of a point's energy lies, because of diffraction.
    // This fraction is approximately (2/pi) v / (v^2 - u^2), with the defocus u. Setting it equal to `tail`
    // gives a quadratic equation for v.
    const double a = 1 / (std::numbers::pi * tail);
    return a + std::hypot(a, u);
}

std::vector<ChannelResponses> diffraction_responses(const FocusGeometry& geometry,
                                                    std::span<const double> coc_diameters_px,
                                                    const DiffractionSettings& settings) {
    check(geometry, coc_diameters_px, settings);
    std::vector<WaveScale> scales;
    for (const SpectralLine& line : settings.spectrum) {
        check_wavelength(line.wavelength_nm);
        scales.push_back(wave_scale(geometry, geometry.inverse_focus_per_m, line.wavelength_nm));
    }
    // Computes the sizes of all impulse responses before the first response, so that insufficient memory is
    // reported early.
    std::vector<Plan> plans;
    BesselGrids bessel;
    double result_bytes = 0, widest_window = 0;
    for (const double coc_px : coc_diameters_px) {
        const Plan& plan = plans.emplace_back(plan_of(coc_px, scales, settings));
        const double pixels = static_cast<double>(plan.window.width) * plan.window.height;
        result_bytes += 3 * pixels * sizeof(double);
        widest_window = std::max(widest_window, 2 * pixels * sizeof(double));
        for (const WaveScale& scale : scales) {
            check_defocus(scale.v_per_px * coc_px / 2);
            const double v_end = plan.reach_px * scale.v_per_px;
            require_memory(static_cast<std::uint64_t>(std::min(v_end * 8 * 5 * sizeof(double), 1e18)),
                           "the diffraction pattern");
            bessel.want(scale.v_per_px * coc_px / 2, v_end);
        }
    }
    const double per_depth =
        static_cast<double>(bessel.longest()) * 3 * sizeof(double) * static_cast<double>(scales.size()) +
        widest_window;
    require_memory(static_cast<std::uint64_t>(result_bytes + per_depth * thread_count() +
                                              static_cast<double>(bessel.longest()) * 4 * sizeof(double)),
                   "diffraction at " + std::to_string(coc_diameters_px.size()) + " depths");
    bessel.make();

    std::vector<ChannelResponses> out(coc_diameters_px.size());
    parallel_for(out.size(), [&](std::size_t d) {
        const Plan& plan = plans[d];
        std::vector<RadialEnergy> energies;
        energies.reserve(scales.size());
        for (const WaveScale& scale : scales) {
            const double u = scale.v_per_px * coc_diameters_px[d] / 2;
            energies.emplace_back(u, plan.reach_px * scale.v_per_px, bessel.of(u));
        }
        for (std::size_t c = 0; c < 3; ++c) {
            ResponseGrid& grid = out[d].channel[c];
            const auto same_light = [c](const SpectralLine& line) {
                return line.weight[c] == line.weight[c - 1];
            };
            if (c > 0 && std::all_of(settings.spectrum.begin(), settings.spectrum.end(), same_light)) {
                grid = out[d].channel[c - 1];
                out[d].loss[c] = out[d].loss[c - 1];
                continue;
            }
            std::vector<RadialProfile::Part> parts;
            for (std::size_t l = 0; l < scales.size(); ++l) {
                const double weight = settings.spectrum[l].weight[c];
                if (weight > 0) parts.push_back({&energies[l], scales[l].v_per_px, weight});
            }
            grid =
                ResponseGrid(plan.window.x_begin, plan.window.y_begin, plan.window.width, plan.window.height);
            fill_pixel_energy(RadialProfile(std::move(parts)), settings.centre_x, settings.centre_y,
                              settings.pixels, grid);
            cut_to_circle(settings.centre_x, settings.centre_y, plan.radius_px, grid);
            const double sum = std::accumulate(grid.share.begin(), grid.share.end(), 0.0);
            out[d].loss[c] = 1 - sum;
            if (settings.fold_tail) {
                for (double& share : grid.share) share /= sum;
            }
        }
        out[d].radius_px = plan.radius_px;
    });
    return out;
}

}  // namespace postlens
