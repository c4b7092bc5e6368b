#include "lens/wave/crossover.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "lens/focus_geometry.h"
#include "lens/wave/wave_scale.h"

namespace postlens {

Crossover crossover(double focal_length_mm, double focus_distance_m, double depth_m, double pixel_pitch_mm,
                    double wavelength_nm) {
    const ThinLens at_one{.focal_length_mm = focal_length_mm, .f_number = 1};
    check_wavelength(wavelength_nm);
    const double V_mm = image_distance_mm(at_one, focus_distance_m);
    (void)focus_geometry(at_one, focus_distance_m, Framing::breathing, {V_mm > 0 ? V_mm : 1, pixel_pitch_mm});
    if (!(depth_m > 0)) {
        fail(ExitCode::wrong_arguments, "depth is out of range (got {} m; expected more than 0, or infinity)",
             depth_m);
    }
    constexpr double mm_per_nm = 1e-6, first_zero = 3.8317059702075125;
    const double airy_mm =
        2 * first_zero / std::numbers::pi * wavelength_nm * mm_per_nm * V_mm / focal_length_mm;
    const double coc_mm = std::abs(coc_diameter_mm(at_one, focus_distance_m, depth_m));
    Crossover out;
    out.over_defocus_f_number = std::sqrt(coc_mm / airy_mm);  // solves airy n = coc / n
    out.over_pixel_f_number = pixel_pitch_mm / airy_mm;
    for (int i = -6; i <= 42; ++i) {
        const double n = std::exp2(i / 6.0);
        out.stops.push_back({n, airy_mm * n, coc_mm / n});
    }
    return out;
}

}  // namespace postlens
