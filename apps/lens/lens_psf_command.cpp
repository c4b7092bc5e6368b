#include "apps/lens/lens_psf_command.h"

#include <cmath>
#include <numbers>

#include "apps/lens/response_picture.h"
#include "apps/numbers.h"
#include "core/files/output_file.h"
#include "lens/wave/crossover.h"
#include "lens/wave/lens_response.h"
#include "pictures/aperture_file.h"
#include "pictures/image.h"

namespace postlens {
namespace {

constexpr double default_wavelength_nm = 550;

double given(const char* option, const std::optional<double>& value, const char* unit) {
    if (value) return *value;
    fail(ExitCode::wrong_arguments, "{}: missing (got nothing; expected {})", option, unit);
}

std::string profile_table(const LensResponse& r, double pixel_pitch_um) {
    std::string text = "radius_um,radius_px,v,intensity,encircled_energy\n";
    for (const RadialSample& s : r.profile) {
        text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", s.radius_px * pixel_pitch_um, s.radius_px,
                            s.v, s.intensity, s.encircled);
    }
    return text;
}

std::string stops_table(const Crossover& c, double pixel_pitch_um) {
    std::string text = "f_number,airy_um,coc_um,pixel_um\n";
    for (const Crossover::Stop& stop : c.stops) {
        text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g}\n", stop.f_number, stop.airy_mm * 1e3,
                            stop.coc_mm * 1e3, pixel_pitch_um);
    }
    return text;
}

CommandResult run_crossover(const LensPsfOptions& o) {
    const double wavelength_nm = o.wavelength_nm.value_or(default_wavelength_nm);
    const Crossover c =
        crossover(given("--focal-length", o.focal_length_mm, "mm"), given("--focus", o.focus_m, "metres"),
                  given("--depth", o.depth_m, "metres"), o.pixel_pitch_um * 1e-3, wavelength_nm);
    if (o.profile) write_file(*o.profile, stops_table(c, o.pixel_pitch_um));
    CommandResult out;
    out.json = {{"over_defocus_f_number", json_number(c.over_defocus_f_number)},
                {"over_pixel_f_number", json_number(c.over_pixel_f_number)},
                {"wavelength_nm", wavelength_nm},
                {"pixel_pitch_um", o.pixel_pitch_um}};
    out.text = fmt::format(
        "diffraction (Airy disc to its first zero, {} nm) is wider than the circle of confusion from "
        "f/{:.4g} on,\n"
        "and wider than a pixel of {} um from f/{:.4g} on",
        wavelength_nm, c.over_defocus_f_number, o.pixel_pitch_um, c.over_pixel_f_number);
    return out;
}

LensResponseRequest request_of(const LensPsfOptions& o) {
    LensResponseRequest q{
        .lens = {.focal_length_mm = given("--focal-length", o.focal_length_mm, "mm"),
                 .f_number = given("--f-number", o.f_number, "a number, or inf")},
        .focus_distance_m = given("--focus", o.focus_m, "metres"),
        .depth_m = given("--depth", o.depth_m, "metres"),
        .pixel_pitch_mm = o.pixel_pitch_um * 1e-3,
        .impulse = o.impulse,
        .wavelength_nm = o.wavelength_nm.value_or(default_wavelength_nm),
        .size_px = o.size_px,
    };
    if (o.wavelength_nm && !q.impulse.wavelengths_nm.empty()) {
        fail(ExitCode::wrong_arguments,
             "--wavelength: --impulse names wavelengths as well (got {} and {}; expected one of them)",
             *o.wavelength_nm, impulse_text(o.impulse));
    }
    return q;
}

}  // namespace

CommandResult run_lens_psf(const LensPsfOptions& o) {
    in_range("--pixel-pitch", o.pixel_pitch_um, 0, false, "more than 0 um");
    if (o.crossover) return run_crossover(o);
    if (o.output.empty())
        fail(ExitCode::wrong_arguments, "OUT: missing (got nothing; expected a file OUT.exr)");
    check_exr_path(o.output, "responses");
    LensResponseRequest q = request_of(o);
    { const OutputFile refuses_early(o.output); }
    if (q.impulse.kind == ImpulseKind::picture) q.aperture = read_aperture(q.impulse);
    const LensResponse r = lens_response(q);
    if (o.profile && r.profile.empty()) {
        fail(ExitCode::wrong_arguments,
             "--profile: the response is not round (got --impulse {}; expected disc or diffraction)",
             impulse_text(o.impulse));
    }
    if (o.profile) write_file(*o.profile, profile_table(r, o.pixel_pitch_um));
    write_response(o.output, r.grid);

    CommandResult out;
    const auto um = [&](double px) { return px * o.pixel_pitch_um; };
    out.json = {{"impulse", impulse_text(o.impulse)},
                {"energy_in_frame", r.energy_in_frame},
                {"peak", r.peak_share},
                {"size_px", r.grid.width},
                {"coc_px", r.coc_px},
                {"coc_mm", um(r.coc_px) * 1e-3},
                {"image_distance_mm", r.image_distance_mm},
                {"wavelength_nm", r.wavelength_nm},
                {"u", r.u},
                {"v_per_px", r.v_per_px},
                {"airy_diameter_um", json_number(um(r.airy_diameter_px))},
                {"first_zero_um", r.u == 0 ? json_number(um(r.airy_diameter_px / 2)) : nullptr},
                {"fwhm_um", r.fwhm_px ? json_number(um(*r.fwhm_px)) : nullptr},
                {"half_energy_diameter_um",
                 r.half_energy_diameter_px ? json_number(um(*r.half_energy_diameter_px)) : nullptr}};
    out.text = fmt::format(
        "{}: {:.6g} of the energy in {}x{} px, {:.6g} in the brightest pixel\n"
        "circle of confusion {:.6g} px, Airy disc {:.6g} px (to the first zero, {:.6g} nm), u = {:.6g}",
        o.output, r.energy_in_frame, r.grid.width, r.grid.height, r.peak_share, r.coc_px, r.airy_diameter_px,
        r.wavelength_nm, r.u);
    return out;
}

}  // namespace postlens
