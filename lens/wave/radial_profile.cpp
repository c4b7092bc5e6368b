#include "lens/wave/radial_profile.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "lens/wave/lommel.h"

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
        // Means B over three neighbouring spans give the middle value of a smooth function as
        // (26 B_0 - B_-1 - B_1) / 24, with an error of 3/640 of the fourth difference.
        const double m0 = p.energy->within_integral(v - 1.5 * w), m1 = p.energy->within_integral(v - 0.5 * w);
        const double m2 = p.energy->within_integral(v + 0.5 * w), m3 = p.energy->within_integral(v + 1.5 * w);
        sum += p.weight * (27 * (m2 - m1) - (m3 - m0)) / (24 * w);
    }
    return sum;
}

double RadialProfile::density(double radius_px) const {
    // dE = I v dv / 2 on a ring of area 2 pi r dr.
    double sum = 0;
    for (const Part& p : parts_) {
        sum += p.weight * lommel_intensity(p.energy->u(), radius_px * p.v_per_px) * p.v_per_px * p.v_per_px;
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace postlens
