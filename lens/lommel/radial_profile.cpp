#include "lens/lommel/radial_profile.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>

#include "lens/lommel/lommel.h"

namespace postlens {

double RadialProfile::end_px() const {
    double end = std::numeric_limits<double>::infinity();
    for (const Part& p : parts_) end = std::min(end, p.energy->v_end() / p.v_per_px);
    return end;
}

double RadialProfile::v_per_px() const {
    double most = 0;
    for (const Part& p : parts_) most = std::max(most, p.v_per_px);
    return most;
}

double RadialProfile::within(double radius_px) const {
    double sum = 0;
    for (const Part& p : parts_) sum += p.weight * p.energy->within(radius_px * p.v_per_px);
    return sum;
}

double RadialProfile::smoothed_within(double radius_px, double width_px) const {
    double sum = 0;
    for (const Part& p : parts_) {
        const double v = radius_px * p.v_per_px, w = width_px * p.v_per_px;
        if (w < 2 * p.energy->step()) {
            sum += p.weight * p.energy->within(v);
            continue;
        }
        // Computes the encircled energy at the optical radius v without narrow diffraction fringes, which
        // average out in the mean over an interval of width w.
        const double m0 = p.energy->within_integral(v - 1.5 * w), m1 = p.energy->within_integral(v - 0.5 * w);
        const double m2 = p.energy->within_integral(v + 0.5 * w), m3 = p.energy->within_integral(v + 1.5 * w);
        // If the energy is a curved function of v, its mean over an interval differs from the value in the
        // middle. To correct this, the means over the intervals around v - w, v and v + w are added with the
        // weights (-1, 26, -1) / 24. For cubic polynomials, this is exact.
        sum += p.weight * (27 * (m2 - m1) - (m3 - m0)) / (24 * w);
    }
    return sum;
}

std::vector<double> RadialProfile::smoothed_row(double begin_px, double width_px, std::size_t count) const {
    constexpr std::size_t half = row_steps / 2, three = 3 * half;
    std::vector<double> out(count), integral(count + 2 * three);
    for (const Part& p : parts_) {
        const double w = width_px * p.v_per_px;
        if (w < 2 * p.energy->step()) {
            for (std::size_t i = 0; i < count; ++i) {
                const double radius_px = begin_px + static_cast<double>(i) * width_px / row_steps;
                out[i] += p.weight * p.energy->within(radius_px * p.v_per_px);
            }
            continue;
        }
        for (std::size_t i = 0; i < integral.size(); ++i) {
            const double steps = static_cast<double>(i) - static_cast<double>(three);
            integral[i] = p.energy->within_integral((begin_px + steps * width_px / row_steps) * p.v_per_px);
        }
        const double scale = p.weight / (24 * w);
        for (std::size_t i = 0; i < count; ++i) {
            out[i] += scale * (27 * (integral[i + three + half] - integral[i + three - half]) -
                               (integral[i + 2 * three] - integral[i]));
        }
    }
    return out;
}

double RadialProfile::density(double radius_px) const {
    // Converts the intensity I, which is relative to the peak in focus, to a fraction of the energy per px^2.
    // A thin ring at the optical radius v, which is v_per_px times the radius r in px, contains the energy I
    // v dv / 2. Divided by the ring's area, 2 pi r dr, this is I v_per_px^2 / (4 pi).
    double sum = 0;
    for (const Part& p : parts_) {
        sum += p.weight * lommel_intensity(p.energy->u(), radius_px * p.v_per_px) * p.v_per_px * p.v_per_px;
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace postlens
