#include "lens/prescription/prescription.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/fingerprint.h"
#include "lens/impulse.h"

namespace postlens {
namespace {

// Largest allowed overlap of neighbouring surfaces, as a fraction of the clear radius. Patents often round
// clear radii up, so surfaces may overlap near their rims.
constexpr double crossing_tolerance = 0.01;

bool all_finite(const Surface& s) {
    return std::isfinite(s.curvature_per_mm) && std::isfinite(s.conic) && std::isfinite(s.thickness_mm) &&
           std::all_of(s.asphere.begin(), s.asphere.end(), [](double a) { return std::isfinite(a); });
}

void check_surface(const Prescription& lens, std::size_t i) {
    const Surface& s = lens.surfaces[i];
    if (!all_finite(s)) {
        fail(ExitCode::invalid_input, "{}: surface {} has a number that is not finite", place_of(lens, i),
             i + 1);
    }
    if (!(s.clear_radius_mm > 0)) {
        fail(ExitCode::invalid_input,
             "{}: clear aperture of surface {} is not positive (got a diameter of {} mm; expected more than "
             "0)",
             place_of(lens, i), i + 1, 2 * s.clear_radius_mm);
    }
    const bool last = i + 1 == lens.surfaces.size();
    if (s.thickness_mm < 0 && !last) {
        fail(ExitCode::invalid_input,
             "{}: thickness after surface {} is negative (got {} mm; expected 0 or more)", place_of(lens, i),
             i + 1, s.thickness_mm);
    }
    const double n = lens.index_after(i);
    if (!(n >= 1 && n <= 5)) {
        fail(ExitCode::invalid_input, "{}: index after surface {} is out of range (got {}; expected 1 to 5)",
             place_of(lens, i), i + 1, n);
    }
}

// Returns the gap between surfaces i and i + 1 at distance r from the axis. It is NaN beyond a surface's
// edge.
double gap_mm(const Prescription& lens, std::size_t i, double r_mm) {
    const Surface& a = lens.surfaces[i];
    return a.thickness_mm + lens.surfaces[i + 1].sag_mm(r_mm) - a.sag_mm(r_mm);
}

struct Crossing {
    double clear_mm = 0;  ///< the smaller of the clear radii
    double met_mm = 0;    ///< smallest distance from the axis at which the surfaces meet
};

// Finds where surfaces i and i + 1 cross within their clear radii.
std::optional<Crossing> crossing(const Prescription& lens, std::size_t i) {
    const double clear = std::min(lens.surfaces[i].clear_radius_mm, lens.surfaces[i + 1].clear_radius_mm);
    if (!std::isfinite(clear)) return std::nullopt;
    constexpr int steps = 64;
    double inside = 0;  // largest r tested so far with a gap >= 0
    for (int step = 1; step <= steps; ++step) {
        const double r = clear * step / steps, gap = gap_mm(lens, i, r);
        if (std::isnan(gap)) return std::nullopt;
        if (gap >= 0) {
            inside = r;
        } else if (gap < -crossing_tolerance * clear) {
            double outside = r;
            for (int halving = 0; halving < 60; ++halving) {
                const double middle = (inside + outside) / 2;
                (gap_mm(lens, i, middle) >= 0 ? inside : outside) = middle;
            }
            return Crossing{clear, inside};
        }
    }
    return std::nullopt;
}

void check_gap(const Prescription& lens, std::size_t i) {
    if (const auto c = crossing(lens, i)) {
        fail(
            ExitCode::invalid_input,
            "{}: surfaces {} and {} cross at {:.4g} mm from the axis, within their clear radius of {:.4g} mm "
            "(expected them to stand apart)",
            place_of(lens, i + 1), i + 1, i + 2, c->met_mm, c->clear_mm);
    }
}

void check_stop(const Prescription& lens) {
    std::size_t stops = 0, last = 0;
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        if (!lens.surfaces[i].is_stop) continue;
        ++stops;
        last = i;
    }
    if (stops == 0) {
        fail(ExitCode::invalid_input, "{}: the lens has no stop (got {} surfaces; expected one marked as it)",
             lens.file, lens.surfaces.size());
    }
    if (stops > 1) {
        fail(ExitCode::invalid_input, "{}: the lens has {} stops (expected one)", place_of(lens, last),
             stops);
    }
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    if (lens.entrance_pupil_diameter_mm && !positive(*lens.entrance_pupil_diameter_mm)) {
        fail(ExitCode::invalid_input,
             "{}: entrance pupil's diameter is out of range (got {} mm; expected more than 0)", lens.file,
             *lens.entrance_pupil_diameter_mm);
    }
    if (lens.f_number && !positive(*lens.f_number)) {
        fail(ExitCode::invalid_input, "{}: f-number is out of range (got {}; expected more than 0)",
             lens.file, *lens.f_number);
    }
    if (!lens.entrance_pupil_diameter_mm && !lens.f_number &&
        !std::isfinite(lens.surfaces[last].clear_radius_mm)) {
        fail(
            ExitCode::invalid_input,
            "{}: nothing says how wide the stop is (expected its diameter, an entrance pupil or an f-number)",
            place_of(lens, last));
    }
}

}  // namespace

bool Surface::is_asphere() const {
    return std::any_of(asphere.begin(), asphere.end(), [](double a) { return a != 0; });
}

double Surface::sag_mm(double r_mm) const {
    const double q = r_mm * r_mm, c = curvature_per_mm;
    double polynomial = 0;
    for (std::size_t i = asphere_terms; i-- > 0;) polynomial = (polynomial + asphere[i]) * q;
    return c * q / (1 + std::sqrt(1 - (1 + conic) * c * c * q)) + polynomial;
}

std::size_t Prescription::stop() const {
    const auto at =
        std::find_if(surfaces.begin(), surfaces.end(), [](const Surface& s) { return s.is_stop; });
    return static_cast<std::size_t>(at - surfaces.begin());
}

double Prescription::length_mm() const {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < surfaces.size(); ++i) sum += surfaces[i].thickness_mm;
    return sum;
}

std::string place_of(const Prescription& lens, std::size_t surface) {
    const int line = lens.surfaces[surface].line;
    return line > 0 ? fmt::format("{}:{}", lens.file, line) : lens.file;
}

std::uint64_t fingerprint(const Prescription& lens) {
    Fingerprint out;
    for (const Surface& s : lens.surfaces) {
        for (const double v : {s.curvature_per_mm, s.conic, s.thickness_mm, s.clear_radius_mm,
                               s.glass.index(lens.wavelength_nm), s.is_stop ? 1.0 : 0.0})
            out.add(v);
        for (const double a : s.asphere) out.add(a);
    }
    constexpr double none = -1;
    for (const double v :
         {lens.wavelength_nm, lens.film_distance_mm.value_or(none), lens.object_distance_mm.value_or(none),
          lens.entrance_pupil_diameter_mm.value_or(none), lens.f_number.value_or(none)})
        out.add(v);
    return out.value();
}

void clip_crossings(Prescription& lens) {
    for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) {
        const auto c = crossing(lens, i);
        if (!c || c->met_mm < 0.01 * c->clear_mm) continue;
        for (const std::size_t k : {i, i + 1})
            lens.surfaces[k].clear_radius_mm = std::min(lens.surfaces[k].clear_radius_mm, c->met_mm);
        lens.notes.push_back(
            fmt::format("{}: surfaces {} and {} cross at {:.4g} mm from the axis, within their "
                        "clear radius of {:.4g} mm: light passes within the former only",
                        place_of(lens, i + 1), i + 1, i + 2, c->met_mm, c->clear_mm));
    }
}

void check_prescription(const Prescription& lens) {
    if (lens.surfaces.empty()) {
        fail(ExitCode::invalid_input, "{}: no surface (expected 1 to {})", lens.file, most_surfaces);
    }
    if (lens.surfaces.size() > most_surfaces) {
        fail(ExitCode::invalid_input, "{}: too many surfaces (got {}; expected 1 to {})", lens.file,
             lens.surfaces.size(), most_surfaces);
    }
    if (!(lens.wavelength_nm >= shortest_wavelength_nm && lens.wavelength_nm <= longest_wavelength_nm)) {
        fail(ExitCode::invalid_input, "{}: wavelength out of range (got {} nm; expected {} to {})", lens.file,
             lens.wavelength_nm, shortest_wavelength_nm, longest_wavelength_nm);
    }
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) check_surface(lens, i);
    check_stop(lens);
    if (lens.film_distance_mm && !(*lens.film_distance_mm > 0 && std::isfinite(*lens.film_distance_mm))) {
        fail(ExitCode::invalid_input,
             "{}: the film is not behind the lens (got {} mm from the last surface; expected more than 0)",
             lens.file, *lens.film_distance_mm);
    }
    for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) check_gap(lens, i);
}

}  // namespace postlens
