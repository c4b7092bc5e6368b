#include <cmath>

#include "apps/lens/lens_command.h"
#include "apps/numbers.h"
#include "core/counted.h"
#include "lens/prescription/read_prescription.h"
#include "lens/traced/lens_models.h"

namespace postlens {
namespace {

nlohmann::ordered_json polynomial_json(const PolynomialLens& p) {
    nlohmann::ordered_json circles = nlohmann::ordered_json::array();
    for (const PupilCircle& c : p.circles) {
        circles.push_back({{"shift", c.shift},
                           {"bend", c.bend},
                           {"radius", c.radius},
                           {"growth", c.growth},
                           {"shift_by_depth", c.shift_by_depth},
                           {"radius_by_depth", c.radius_by_depth}});
    }
    return {{"pupil_radius_mm", p.pupil_radius_mm},
            {"largest_tangent", p.largest_tangent},
            {"inverse_focus_per_m", p.inverse_focus_per_m},
            {"largest_defocus_per_m", p.largest_defocus_per_m},
            {"x_mm", p.x_mm},
            {"y_mm", p.y_mm},
            {"circles", circles}};
}

}  // namespace

CommandResult run_lens_fit(const LensFitOptions& o) {
    CommandResult out;
    const Prescription lens = read_lens(o.lens.input, out.warnings);
    const TracedLens traced(lens, traced_lens_settings(o.lens, std::max(o.field_mm, 1e-3)));
    check_depth("--depths", o.depths_m.first, traced);
    const auto range_of = [&](int samples) {
        return lens_model_range(traced, o.depths_m.first, o.depths_m.second, o.field_mm, samples);
    };
    LensModels models(lens, traced);
    const PolynomialLens polynomial = fit_polynomial_lens(lens, traced, range_of(o.samples));
    // `range` describes the rays at which the fitted lens models are tested. The polynomial was fitted to a
    // grid of rays, `o.samples` per axis. The test grid has twice this density, so every second ray lies
    // halfway between fitted rays, where the errors may be larger.
    const LensModelRange range = range_of(2 * o.samples - 1);
    models.set_polynomial(polynomial);
    const double px_per_mm = 1000 / o.pixel_pitch_um;
    nlohmann::ordered_json table = nlohmann::ordered_json::array();
    std::optional<LensModelKind> picked;
    std::string rows;
    for (std::size_t i = 0; i < lens_model_kinds; ++i) {
        const auto kind = static_cast<LensModelKind>(i);
        const double error_px = models.error_mm(kind, range) * px_per_mm;
        if (!picked && error_px <= o.tolerance_px) picked = kind;
        table.push_back({{"model", name_of(kind)}, {"error_px", error_px}});
        rows += fmt::format("\n{:<11} {:>10.4g} px{}", name_of(kind), error_px,
                            picked == kind ? "  <- cheapest within the tolerance" : "");
    }
    out.json = {{"picked", name_of(*picked)},  // never empty, because the traced lens has no error
                {"tolerance_px", o.tolerance_px},
                {"models", table},
                {"focal_length_mm", traced.first_order().efl_mm},
                {"f_number", traced.f_number()},
                {"depths_m", nlohmann::ordered_json::array()},
                {"largest_tangent", range.tangents.back()},
                {"thick",
                 {{"film_mm_per_pupil_mm_at_infinity", models.thick_at_infinity()},
                  {"film_mm_m_per_pupil_mm", models.thick_per_depth_m()}}},
                {"polynomial", polynomial_json(polynomial)}};
    for (const double depth : range.depths_m) out.json["depths_m"].push_back(json_number(depth));
    out.text = fmt::format(
        "{}: largest error over {} from {:g} m to {:g} m and {} up to {:g} mm, px of {:g} um{}", o.lens.input,
        counted(range.depths_m.size(), "depth"), o.depths_m.first, o.depths_m.second,
        counted(range.tangents.size(), "field"), o.field_mm, o.pixel_pitch_um, rows);
    return out;
}

}  // namespace postlens
