#include "lens/fits/sharp_range.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/units.h"
#include "lens/wave/wave_scale.h"

namespace postlens {
namespace {

constexpr double fastest = 0.7;  ///< f-number of the fastest photographic lenses

SharpLens solve(double focal_length_mm, double s_m, const SharpRangeRequest& request) {
    const double F_m = focal_length_mm * metres_per_mm;
    SharpLens lens{.focal_length_mm = focal_length_mm};
    if (F_m >= request.near_m) {
        lens.why_not = fmt::format("the near limit lies within the focal length ({} mm)", focal_length_mm);
        return lens;
    }
    const double inverse_range = 1 / request.near_m - 1 / request.far_m,
                 stretch = 1 / (1 - F_m / s_m);  // V/F, V: film distance
    lens.f_number =
        std::max(focal_length_mm * F_m * inverse_range / (2 * request.coc_limit_mm) * stretch, fastest);
    // The Airy disc's diameter is 2.44 lambda V / D, with wavelength lambda, film distance V and aperture
    // diameter D.
    constexpr double airy_per_wave = 2.4393397823, mm_per_nm = 1e-6;
    lens.largest_f_number =
        request.coc_limit_mm / (airy_per_wave * request.wavelength_nm * mm_per_nm * stretch);
    if (lens.f_number > lens.largest_f_number) {
        lens.why_not =
            fmt::format("needs f/{:.3g}, and from f/{:.3g} on the Airy disc is wider than the limit",
                        lens.f_number, lens.largest_f_number);
    }
    return lens;
}

}  // namespace

SharpRange sharp_range(const SharpRangeRequest& request) {
    if (!(request.near_m > 0) || !(request.far_m > request.near_m)) {
        fail(ExitCode::wrong_arguments,
             "sharp range is out of order (got {} m to {} m; expected 0 < NEAR < FAR)", request.near_m,
             request.far_m);
    }
    if (!(request.coc_limit_mm > 0) || std::isinf(request.coc_limit_mm)) {
        fail(ExitCode::wrong_arguments,
             "limit of the circle of confusion is out of range (got {} mm; expected more than 0)",
             request.coc_limit_mm);
    }
    if (request.focal_length_mm &&
        (!(*request.focal_length_mm > 0) || std::isinf(*request.focal_length_mm))) {
        fail(ExitCode::wrong_arguments,
             "focal length is out of range (got {} mm; expected more than 0 and finite)",
             *request.focal_length_mm);
    }
    check_wavelength(request.wavelength_nm);
    SharpRange out;
    out.focus_distance_m = 2 / (1 / request.near_m + 1 / request.far_m);
    if (request.focal_length_mm) {
        out.lenses.push_back(solve(*request.focal_length_mm, out.focus_distance_m, request));
    } else {
        for (const double F_mm : {14, 18, 24, 28, 35, 50, 70, 85, 105, 135, 200, 300}) {
            out.lenses.push_back(solve(F_mm, out.focus_distance_m, request));
        }
    }
    return out;
}

}  // namespace postlens
