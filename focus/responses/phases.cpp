#include "focus/responses/phases.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "focus/responses/kernel.h"

namespace postlens {
namespace {

/// Smallest CoC radius, in px, at which a sample is blurred as a whole. A sample represents a quarter of each
/// of the four quadtree cells around it. If the radius is smaller, each quarter may have its own blur disc,
/// because their different positions are then visible.
constexpr double one_disc_from_px = 2;

/// Returns the number of subpixel positions, along each axis, for which kernels of this radius are computed.
int phases_per_px(double radius_px) {
    if (radius_px <= 16) return 16;
    return radius_px <= 256 ? 4 : 1;
}

/// Returns how far, in px, to move a sample at a corner between quadtree cells of different sizes. The move
/// corrects an integration error that would blur edges.
///
/// The trapezoidal rule integrates over a row of cells of width h, from samples at their corners. Its error
/// is h^2 / 12 times the slope at each end (Euler-Maclaurin). A sample has the weight h / 2 in each of the
/// two cells beside it. This half moves by h / 6 into its cell, which cancels the error: (h / 2) (h / 6) =
/// h^2 / 12.
std::pair<float, float> shift_between_leaves(const PointSample& s) {
    float x = 0, y = 0;
    for (std::size_t q = 0; q < 4; ++q) {
        const float moment = s.weight[q] * s.leaf_size[q] / 6;
        x += q % 2 == 0 ? -moment : moment;
        y += q / 2 == 0 ? -moment : moment;
    }
    const float total = s.total_weight();
    return total > 0 ? std::pair(x / total, y / total) : std::pair(0.0F, 0.0F);
}

/// Rounds a position inside a pixel, from 0 to 1 px, to the nearest subpixel position that does not lie on
/// the pixel's border.
std::int32_t phase_inside(float fraction) {
    return std::clamp(static_cast<std::int32_t>(std::lround(fraction * KernelKey::phase_steps)), 1,
                      KernelKey::phase_steps - 1);
}

}  // namespace

Phases phases_of(const PointSample& s, double radius_px) {
    Phases out;
    const float fx = s.x - std::floor(s.x), fy = s.y - std::floor(s.y);
    const std::array<float, 4>& w = s.weight;
    const bool even = w[0] == w[1] && w[0] == w[2] && w[0] == w[3];
    if (fx == 0 && fy == 0 && even) {
        out.add(0, 0, s.total_weight());
        return out;
    }
    if (radius_px >= one_disc_from_px) {
        const int steps = phases_per_px(radius_px);
        const int unit = KernelKey::phase_steps / steps;
        const auto [shift_x, shift_y] = shift_between_leaves(s);
        const float x = (fx + shift_x) * static_cast<float>(steps),
                    y = (fy + shift_y) * static_cast<float>(steps);
        const float x0 = std::floor(x), y0 = std::floor(y);
        for (int corner = 0; corner < 4; ++corner) {
            const bool right = corner % 2 != 0, down = corner / 2 != 0;
            const float share = (right ? x - x0 : 1 - (x - x0)) * (down ? y - y0 : 1 - (y - y0));
            if (share == 0) continue;
            out.add((static_cast<std::int32_t>(x0) + (right ? 1 : 0)) * unit,
                    (static_cast<std::int32_t>(y0) + (down ? 1 : 0)) * unit, share * s.total_weight());
        }
        return out;
    }
    const bool one_pixel = fx != 0 && fy != 0;
    if (one_pixel || even) {
        out.add(fx == 0 ? 0 : phase_inside(fx), fy == 0 ? 0 : phase_inside(fy), s.total_weight());
        return out;
    }
    for (std::size_t q = 0; q < 4; ++q) {
        if (w[q] == 0) continue;
        // The sample is a corner of up to four quadtree cells (q = 0 to 3), and represents a quarter of each.
        // If it lies on a pixel border in x (fx is 0), the quarter's light is added at the quarter's centre,
        // at the distance `move` in units of 1/16 px. Otherwise, it is added at the sample's own x.
        const auto move = std::max<std::int32_t>(
            1, static_cast<std::int32_t>(s.leaf_size[q] * (static_cast<float>(KernelKey::phase_steps) / 4)));
        out.add(fx == 0 ? (q % 2 == 0 ? -move : move) : phase_inside(fx),
                fy == 0 ? (q / 2 == 0 ? -move : move) : phase_inside(fy), w[q]);
    }
    return out;
}

}  // namespace postlens
