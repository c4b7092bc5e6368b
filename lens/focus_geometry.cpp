#include "lens/focus_geometry.h"

#include <cmath>

#include "core/error.h"
#include "core/units.h"

namespace postlens {
namespace {

void check(const ThinLens& lens, double focus_distance_m, Framing framing) {
    if (!(lens.focal_length_mm > 0) || std::isinf(lens.focal_length_mm)) {
        fail(ExitCode::wrong_arguments,
             "focal length is out of range (got {} mm; expected more than 0 and finite)",
             lens.focal_length_mm);
    }
    if (!(lens.f_number > 0)) {
        fail(ExitCode::wrong_arguments,
             "f-number is out of range (got {}; expected more than 0, or infinity for a pinhole)",
             lens.f_number);
    }
    if (!(focus_distance_m > 0)) {
        fail(ExitCode::wrong_arguments,
             "focus distance is out of range (got {} m; expected more than 0, or infinity)",
             focus_distance_m);
    }
    if (framing != Framing::keep && focus_distance_m <= lens.focal_length_mm * metres_per_mm) {
        fail(ExitCode::wrong_arguments,
             "focus distance lies within the focal length, where the lens forms no real image to frame (got "
             "{} m; "
             "expected more than {} m, or the framing of the trace kept)",
             focus_distance_m, lens.focal_length_mm * metres_per_mm);
    }
}

double film_distance_mm(const ThinLens& lens, double focus_distance_m, Framing framing, const Film& film) {
    switch (framing) {
        case Framing::lens:
            return lens.focal_length_mm;
        case Framing::breathing:
            return image_distance_mm(lens, focus_distance_m);
        case Framing::keep:
            break;
    }
    return film.distance_mm;
}

}  // namespace

void check_film(const Film& film) {
    if (!(film.distance_mm > 0) || !(film.pixel_pitch_mm > 0) || !std::isfinite(film.distance_mm) ||
        !std::isfinite(film.pixel_pitch_mm)) {
        fail(ExitCode::wrong_arguments,
             "film is out of range (got a distance of {} mm and a pixel pitch of {} mm; expected both more "
             "than 0)",
             film.distance_mm, film.pixel_pitch_mm);
    }
}

FocusGeometry focus_geometry(const ThinLens& lens, double focus_distance_m, Framing framing,
                             const Film& film) {
    check(lens, focus_distance_m, framing);
    check_film(film);
    const double distance_mm = film_distance_mm(lens, focus_distance_m, framing, film);
    return {.aperture_radius_m = lens.aperture_diameter_mm() / 2 * metres_per_mm,
            .inverse_focus_per_m = 1 / focus_distance_m,
            .gain_px = distance_mm / film.pixel_pitch_mm,
            .zoom = distance_mm / film.distance_mm};
}

}  // namespace postlens
