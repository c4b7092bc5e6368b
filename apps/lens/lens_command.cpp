#include "apps/lens/lens_command.h"

#include <cmath>

#include "apps/numbers.h"

namespace postlens {
namespace {

ThinLens checked_lens(const LensCommandOptions& o) {
    in_range("--focal-length", o.focal_length_mm, 0, false, "more than 0 mm");
    in_range("--f-number", o.f_number, 0, false, "more than 0");
    in_range("--coc-limit", o.coc_limit_mm, 0, false, "more than 0 mm");
    in_range("--pixel-pitch", o.pixel_pitch_um, 0, false, "more than 0 um");
    in_range("--focus", o.focus_m, o.focal_length_mm * 1e-3, false,
             "more than the focal length: nearer, the lens forms no real image");
    return {o.focal_length_mm, o.f_number};
}

std::string metres(double value) {
    return std::isfinite(value) ? fmt::format("{:.6g} m", value) : "infinity";
}

CommandResult answer(const LensCommandOptions& o, double coc_mm) {
    const DepthOfField dof = depth_of_field({o.focal_length_mm, o.f_number}, o.focus_m, o.coc_limit_mm);
    CommandResult out;
    out.json = {{"coc_mm", json_number(coc_mm)},
                {"coc_px", json_number(coc_mm * 1000 / o.pixel_pitch_um)},
                {"near_m", json_number(dof.near_m)},
                {"far_m", json_number(dof.far_m)},
                {"hyperfocal_m", json_number(dof.hyperfocal_m)}};
    out.text = fmt::format("sharp from {} to {} (circle of confusion up to {} mm); hyperfocal distance {}",
                           metres(dof.near_m), metres(dof.far_m), o.coc_limit_mm, metres(dof.hyperfocal_m));
    return out;
}

}  // namespace

void check_depth(std::string_view option, double depth_m, const TracedLens& lens) {
    const double nearest_m = lens.pinhole_from_vertex_mm() * 1e-3;
    if (depth_m > nearest_m) return;
    fail(ExitCode::wrong_arguments,
         "{}: within the lens (got {} m; expected more than {:.6g} m, where the first surface is)", option,
         depth_m, nearest_m);
}

CommandResult run_lens_coc(const LensCommandOptions& options) {
    const ThinLens lens = checked_lens(options);
    if (!options.depth_m) fail(ExitCode::wrong_arguments, "--depth: missing (got nothing; expected metres)");
    in_range("--depth", *options.depth_m, 0, false, "more than 0 m");
    const double coc_mm = coc_diameter_mm(lens, options.focus_m, *options.depth_m);
    CommandResult out = answer(options, coc_mm);
    out.text = fmt::format("circle of confusion {:.6g} mm, {:.6g} px of {} um ({})\n{}", coc_mm,
                           coc_mm * 1000 / options.pixel_pitch_um, options.pixel_pitch_um,
                           coc_mm == 0  ? "in focus"
                           : coc_mm > 0 ? "behind the focus"
                                        : "in front of the focus",
                           out.text);
    return out;
}

CommandResult run_lens_dof(const LensCommandOptions& options) {
    (void)checked_lens(options);
    return answer(options, options.coc_limit_mm);
}

}  // namespace postlens
