#include "lens/thin_lens.h"

#include <cmath>

#include "core/units.h"

namespace postlens {
namespace {

/// Returns 1/s - 1/z, in 1/m. It stays precise if s and z are nearly equal, and one of them may be infinite.
double inverse_difference_per_m(double s_m, double z_m) {
    if (std::isfinite(s_m) && std::isfinite(z_m)) return (z_m - s_m) / z_m / s_m;
    return 1 / s_m - 1 / z_m;
}

}  // namespace

double image_distance_mm(const ThinLens& lens, double focus_distance_m) {
    return lens.focal_length_mm / (1 - lens.focal_length_mm * metres_per_mm / focus_distance_m);
}

double coc_diameter_mm(const ThinLens& lens, double focus_distance_m, double depth_m) {
    // Circle of confusion F^2 (z - s) / (n z (s - F)) [potmesil1981, eq. 3], for focal length F and f-number
    // n. It is rearranged so that the depth z and the focus distance s may be infinite.
    return image_distance_mm(lens, focus_distance_m) * lens.aperture_diameter_mm() * metres_per_mm *
           inverse_difference_per_m(focus_distance_m, depth_m);
}

DepthOfField depth_of_field(const ThinLens& lens, double focus_distance_m, double coc_limit_mm) {
    const double focal_m = lens.focal_length_mm * metres_per_mm;
    const double s = focus_distance_m;
    // The hyperfocal distance minus the focal length, in m. It is infinite if coc_limit_mm is 0.
    const double q =
        lens.focal_length_mm * lens.focal_length_mm / (lens.f_number * coc_limit_mm) * metres_per_mm;
    DepthOfField out;
    out.hyperfocal_m = q + focal_m;
    if (std::isinf(s)) {
        out.near_m = q;
        return out;
    }
    const double beyond_focal_m = s - focal_m;
    // This equals q s / (q + s - F), with the focal length F, but also holds if q is infinite.
    out.near_m = q > 0 ? s / (1 + beyond_focal_m / q) : 0;
    if (s < out.hyperfocal_m) out.far_m = s / (1 - beyond_focal_m / q);
    return out;
}

}  // namespace postlens
