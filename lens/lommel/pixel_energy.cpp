#include "lens/lommel/pixel_energy.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/threads.h"
#include "lens/lommel/quadrature.h"

namespace postlens {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Returns the flow of energy through a pixel border near the blur kernel's centre. This flow is only
/// imagined (see Flow). Relative to the centre, the border is a vertical line at x from y0 to y1, in px.
double near_flow(const RadialProfile& profile, double x, double y0, double y1) {
    // If the pixel border lies on a line through the kernel's centre, the energy flow is parallel to the
    // border, so no energy crosses it. A border whose line passes the centre at less than nothing_px is
    // treated alike, to avoid a division by nearly 0.
    constexpr double nothing_px = 1e-7;
    const double distance = std::abs(x);
    if (distance < nothing_px) return 0;
    // Integrates the energy flow over the points (x, y) of the border, at the distances r from the kernel's
    // centre. The kernel's energy L within r flows out through a circle of circumference 2 pi r, so the flow
    // is L / (2 pi r) per px of the circle. Only its horizontal component, the fraction x / r, crosses the
    // vertical border. With y = x sinh t and r = x cosh t, the integrand over t becomes L / (2 pi cosh t).
    const double t0 = std::asinh(y0 / distance), t1 = std::asinh(y1 / distance);
    // Integrates the energy flow over t = asinh(y / x) in panels (intervals) with 16 quadrature nodes each. A
    // panel spans at most 6 units of the optical radius v, so that the nodes resolve diffraction fringes. At
    // most 64 panels are used, because even finer fringes cancel in the integral.
    const double longest_r = std::hypot(x, std::max(std::abs(y0), std::abs(y1)));
    const double panels_wanted = std::max((t1 - t0) * longest_r * profile.v_per_px() / 6, t1 - t0);
    const int panels = static_cast<int>(std::clamp(std::ceil(panels_wanted), 1.0, 64.0));
    const double width = (t1 - t0) / panels;
    double sum = 0;
    for (int i = 0; i < panels; ++i) {
        for (const GaussNode& node : gauss_legendre_16()) {
            const double r_of_x = std::cosh(t0 + (i + node.x) * width);
            sum += node.weight * profile.within(distance * r_of_x) / r_of_x;
        }
    }
    return std::copysign(sum * width / two_pi, x);
}

/// Returns the width, in px, over which the energy of a blur kernel is averaged to remove diffraction
/// fringes. Narrow fringes would fall between the quadrature nodes of the integrals along pixel borders. A
/// width of 70 % of the distance between nodes gives the smallest error.
double smoothing_px(const PixelEnergySettings& settings) {
    return 0.7 / settings.nodes;
}

/// A table for the energy flow (see Flow) through vertical pixel borders. For each distance r, in px, from
/// the blur kernel's centre, it contains L / (2 pi r^2), where L is the kernel's energy within r. This value
/// times the border's horizontal distance x is the flow per px of the border.
class FlowTable {
  public:
    FlowTable(const RadialProfile& profile, double begin_px, double end_px, double width_px)
        : begin_(begin_px), per_px_(RadialProfile::row_steps / width_px) {
        const auto count = static_cast<std::size_t>(std::ceil((end_px - begin_px) * per_px_)) + 2;
        values_ = profile.smoothed_row(begin_px, width_px, count);
        for (std::size_t i = 0; i < count; ++i) {
            const double r = begin_ + static_cast<double>(i) / per_px_;
            values_[i] /= two_pi * r * r;
        }
    }
    [[nodiscard]] double at(double r) const {
        const double at = (r - begin_) * per_px_;
        const auto i = static_cast<std::size_t>(at);
        const double t = at - static_cast<double>(i);
        return values_[i] + t * (values_[i + 1] - values_[i]);
    }

  private:
    double begin_, per_px_;
    std::vector<double> values_;
};

/// Computes how much energy flows through pixel borders that are parallel to the y axis. This flow is only
/// imagined: it is directed away from the blur kernel's centre, so that the net flow out of a pixel is the
/// kernel's energy in this pixel.
class Flow {
  public:
    Flow(const RadialProfile& profile, const PixelEnergySettings& settings, double end_px)
        : profile_(profile),
          settings_(settings),
          table_(profile, settings.near_px, std::max(end_px, settings.near_px), smoothing_px(settings)) {}

    [[nodiscard]] double through(double x, double y0, double y1) const {
        const double nearest_y = y0 <= 0 && y1 >= 0 ? 0 : std::min(std::abs(y0), std::abs(y1));
        const double furthest_y = std::max(std::abs(y0), std::abs(y1));
        const double r0 = std::sqrt(x * x + nearest_y * nearest_y);
        if (r0 < settings_.near_px) return near_flow(profile_, x, y0, y1);
        constexpr double node = 0.21132486540518713;  // (1 - 1/sqrt(3)) / 2
        const double span = std::sqrt(x * x + furthest_y * furthest_y) - r0;
        const int pairs = std::max(2, static_cast<int>(std::ceil(span * settings_.nodes / 2)));
        const double step = (y1 - y0) / pairs;
        double sum = 0;
        for (int i = 0; i < pairs; ++i) {
            const double a = y0 + (i + node) * step, b = y0 + (i + 1 - node) * step;
            sum += table_.at(std::sqrt(x * x + a * a)) + table_.at(std::sqrt(x * x + b * b));
        }
        return sum * step / 2 * x;
    }

  private:
    const RadialProfile& profile_;
    PixelEnergySettings settings_;
    FlowTable table_;
};

/// Contains the flow of the kernel's energy (see Flow) through each pixel border. If the kernel is centred on
/// a corner or the centre of a pixel, the flows in its four quadrants are equal. Then only those of one
/// quadrant are computed and stored.
class Borders {
  public:
    Borders(const Flow& flow, double centre_x, double centre_y, int reach) : flow_(flow) {
        const double offset = centre_x - std::floor(centre_x);
        if (offset != centre_y - std::floor(centre_y) || (offset != 0 && offset != 0.5)) return;
        size_ = static_cast<std::size_t>(reach) + 2;
        quadrant_.resize(size_ * size_);
        parallel_for(size_, [&](std::size_t line) {
            for (std::size_t row = 0; row < size_; ++row) {
                const double x = static_cast<double>(line) + offset, y = static_cast<double>(row) - offset;
                if (std::max(x, y + 1) > reach + 1) break;
                quadrant_[line * size_ + row] = std::hypot(x, y + 1) > 0 ? flow.through(x, y, y + 1) : 0;
            }
        });
    }
    /// Returns the flow of energy (see Flow) in +x direction through the pixel border from (x, y0) to (x, y0
    /// + 1), in px relative to the kernel's centre. The flow is a fraction of the kernel's energy.
    [[nodiscard]] double through(double x, double y0) const {
        if (quadrant_.empty()) return flow_.through(x, y0, y0 + 1);
        const auto line = static_cast<std::size_t>(std::abs(x));
        const auto row = static_cast<std::size_t>(std::abs(y0 + 0.5));
        return std::copysign(quadrant_[line * size_ + row], x);
    }

  private:
    const Flow& flow_;
    std::size_t size_ = 0;
    std::vector<double> quadrant_;
};

double furthest(int begin, int size, double centre) {
    return std::max(std::abs(begin - centre), std::abs(begin + size - centre));
}

}  // namespace

double reach_px(const ResponseGrid& grid, double centre_x, double centre_y,
                const PixelEnergySettings& settings) {
    const double x = furthest(grid.x_begin, grid.width, centre_x);
    const double y = furthest(grid.y_begin, grid.height, centre_y);
    // Radius to which `profile`, the energy within each radius, must extend: to the corners of the square
    // around the kernel's centre in which pixel energies are computed, and at least to `near_px`. Averaging
    // the profile to remove diffraction fringes needs a margin of 4 smoothing_px.
    return std::max(std::numbers::sqrt2 * (std::max(x, y) + 1), settings.near_px) +
           4 * smoothing_px(settings);
}

void fill_pixel_energy(const RadialProfile& profile, double centre_x, double centre_y,
                       const PixelEnergySettings& settings, ResponseGrid& grid) {
    const double reach = reach_px(grid, centre_x, centre_y, settings);
    assert(profile.end_px() >= reach);
    const Flow flow(profile, settings, reach - 2 * smoothing_px(settings));
    const Borders borders(flow, centre_x, centre_y,
                          static_cast<int>(std::max(furthest(grid.x_begin, grid.width, centre_x),
                                                    furthest(grid.y_begin, grid.height, centre_y))));
    const auto width = static_cast<std::size_t>(grid.width);
    std::vector<double> down(width * (static_cast<std::size_t>(grid.height) + 1));
    parallel_for(static_cast<std::size_t>(grid.height) + 1, [&](std::size_t j) {
        const double y = grid.y_begin + static_cast<double>(j) - centre_y;
        for (std::size_t i = 0; i < width; ++i) {
            down[j * width + i] = borders.through(y, grid.x_begin + static_cast<double>(i) - centre_x);
        }
    });
    parallel_for(static_cast<std::size_t>(grid.height), [&](std::size_t j) {
        const double y = grid.y_begin + static_cast<double>(j) - centre_y;
        double left = borders.through(grid.x_begin - centre_x, y);
        for (std::size_t i = 0; i < width; ++i) {
            const double right = borders.through(grid.x_begin + static_cast<double>(i + 1) - centre_x, y);
            const double share = right - left + down[(j + 1) * width + i] - down[j * width + i];
            grid.share[j * width + i] = std::max(share, 0.0);
            left = right;
        }
    });
}

}  // namespace postlens
