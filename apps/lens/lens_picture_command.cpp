#include <cmath>

#include "apps/lens/lens_fit_limits_command.h"
#include "apps/numbers.h"
#include "compare/lens_from_picture.h"
#include "core/counted.h"
#include "pictures/exposure.h"
#include "pictures/image.h"

namespace postlens {
namespace {

/// Returns the focus distance in metres. It is infinite if its inverse is 0.
double focus_m(const LensPlace& place) {
    return 1 / place.inverse_focus_per_m;
}

nlohmann::ordered_json candidate_json(const LensCandidate& c, double focal_length_mm) {
    return {{"f_number", focal_length_mm / c.place.aperture_mm},
            {"focus_m", json_number(focus_m(c.place))},
            {"aperture_mm", c.place.aperture_mm},
            {"error", c.error}};
}

}  // namespace

CommandResult run_lens_fit_picture(const LensFitLimitsOptions& o) {
    if (!o.frame) {
        fail(ExitCode::wrong_arguments,
             "--frame: missing (got --picture alone; expected the sample file of the same view)");
    }
    const SampleFileReader file(*o.frame);
    const double focal_length_mm = o.focal_length_mm.value_or(file.header().focal_length_mm);
    in_range("--focal-length", focal_length_mm, 0, false, "more than 0 mm");
    Image picture = read_image(*o.picture);
    set_exposure(picture, file.exposure_stops());
    LensFromPicture found;
    try {
        found = lens_from_picture(file, picture, {.impulse = o.impulse});
    } catch (const Error& e) {
        if (e.code() != ExitCode::invalid_input) throw;
        fail(e.code(), "{}: {}", *o.picture, e.what());
    }
    const LensPlace& best = found.best.place;
    const double f_number = focal_length_mm / best.aperture_mm, s_m = focus_m(best);
    const double f_number_error = f_number * found.aperture_error_mm / best.aperture_mm;
    const double focus_error_m = s_m * s_m * found.inverse_focus_error_per_m;
    CommandResult out;
    warn_of_missing_rows(file, out.warnings);
    out.json = {{"focal_length_mm", focal_length_mm},
                {"f_number", f_number},
                {"f_number_error", f_number_error},
                {"focus_m", json_number(s_m)},
                {"focus_error_m", json_number(focus_error_m)},
                {"aperture_mm", best.aperture_mm},
                {"aperture_error_mm", found.aperture_error_mm},
                {"inverse_focus_per_m", best.inverse_focus_per_m},
                {"inverse_focus_error_per_m", found.inverse_focus_error_per_m},
                {"correlation", found.correlation},
                {"error", found.best.error},
                {"pinhole_error", found.pinhole_error},
                {"spread", found.spread},
                {"reliable_share", found.reliable_share},
                {"largest_coc_px", found.largest_coc_px},
                {"pictures", found.pictures},
                {"others", nlohmann::ordered_json::array()}};
    for (const LensCandidate& c : found.others) {
        out.json["others"].push_back(candidate_json(c, focal_length_mm));
        out.warnings.push_back(
            {.code = "ambiguous",
             .text = fmt::format(
                 "another lens is nearly as good: f/{:.4g}, focused at {:.4g} m (error {:.3g} "
                 "against {:.3g})",
                 focal_length_mm / c.place.aperture_mm, focus_m(c.place), c.error, found.best.error)});
    }
    out.text = fmt::format(
        "F = {:.6g} mm, f/{:.5g} +- {:.2g}, focused at {:.5g} +- {:.2g} m; error {:.3g}, without a lens "
        "{:.3g}, "
        "over {:.0f} % of the pixels; widest CoC {:.3g} px, {} focused",
        focal_length_mm, f_number, f_number_error, s_m, focus_error_m, found.best.error, found.pinhole_error,
        100 * found.reliable_share, found.largest_coc_px, counted(found.pictures, "picture"));
    return out;
}

}  // namespace postlens
