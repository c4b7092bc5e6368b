#include <cmath>
#include <numbers>

#include "apps/lens/lens_command.h"
#include "apps/lens/lens_drawing.h"
#include "apps/numbers.h"
#include "core/counted.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/read_prescription.h"
#include "lens/traced/lens_models.h"

namespace postlens {
namespace {

double degrees(double tangent) {
    return std::atan(tangent) * 180 / std::numbers::pi;
}

// Returns the tangent of the largest field angle at which rays are drawn. It follows from the film width, or
// else from the field angles in the prescription.
double edge_tangent(const TracedLens& traced, const Prescription& lens, std::optional<double> film_width_mm) {
    double tangent = 0.36;  // of a 36 mm wide film and a 50 mm lens
    if (!lens.field_angles_deg.empty()) {
        double widest = 0;
        for (const double deg : lens.field_angles_deg) widest = std::max(widest, std::abs(deg));
        tangent = std::tan(std::min(widest, 80.0) * std::numbers::pi / 180);
    }
    if (film_width_mm) tangent = 0.5 * *film_width_mm / traced.first_order().efl_mm;
    // Reduces the angle until light passes through the lens.
    PupilMesh mesh;
    for (int step = 0; step < 8 && !traced.impulse(HUGE_VAL, {0, tangent}, 16, mesh); ++step) tangent *= 0.8;
    return tangent;
}

nlohmann::ordered_json numbers_json(const FirstOrder& f) {
    return {{"efl_mm", json_number(f.efl_mm)},
            {"bfl_mm", json_number(f.bfl_mm)},
            {"ffl_mm", json_number(f.ffl_mm)},
            {"f_number", json_number(f.f_number)},
            {"entrance_pupil_diameter_mm", json_number(f.entrance_pupil_diameter_mm)},
            {"entrance_pupil_z_mm", json_number(f.entrance_pupil_z_mm)},
            {"exit_pupil_diameter_mm", json_number(f.exit_pupil_diameter_mm)},
            {"exit_pupil_z_mm", json_number(f.exit_pupil_z_mm)},
            {"front_principal_z_mm", json_number(f.front_principal_z_mm)},
            {"rear_principal_z_mm", json_number(f.rear_principal_z_mm)},
            {"film_distance_mm", json_number(f.film_distance_mm)}};
}

// Returns the field of view, in degrees, on a film of the given width. It includes distortion, because chief
// rays are traced.
std::optional<double> traced_field_deg(const TracedLens& traced, double film_width_mm) {
    try {
        return 2 * degrees(lens_model_range(traced, 1, 2, 0.5 * film_width_mm, 2).tangents.back());
    } catch (const Error&) {
        return std::nullopt;  // no chief ray reaches the film's edge
    }
}

}  // namespace

TracedLensSettings traced_lens_settings(const PrescriptionOptions& o, double film_radius_mm) {
    return {.focus_distance_m = o.focus_m,
            .f_number = o.f_number,
            .wavelength_nm = o.wavelength_nm,
            .criterion = o.criterion,
            .move = o.move,
            .film_radius_mm = film_radius_mm};
}

CommandResult run_lens_show(const LensShowOptions& o) {
    if (o.film_width_mm) in_range("--film-width", *o.film_width_mm, 0, false, "more than 0 mm");
    if (o.output) check_drawing_path(*o.output);
    CommandResult out;
    const Prescription lens = read_lens(o.lens.input, out.warnings);
    const double nm = o.lens.wavelength_nm.value_or(lens.wavelength_nm);
    FirstOrder f = first_order(lens, nm);
    const double film_radius =
        o.film_width_mm ? 0.5 * *o.film_width_mm : std::max(1e-3, 0.43 * std::abs(f.efl_mm));
    std::optional<TracedLens> traced;
    // `traced` is the lens through which rays are traced. It is not made for a diverging lens, because
    // TracedLens throws for such a lens. Then only the data of paraxial optics are reported, such as the
    // focal length. But if an option needs traced rays, the error is intended.
    if (f.efl_mm > 0 || o.output || o.lens.f_number || o.lens.focus_m) {
        traced.emplace(lens, traced_lens_settings(o.lens, film_radius));
        const double ratio = f.f_number / traced->f_number();
        f.f_number = traced->f_number();
        f.entrance_pupil_diameter_mm *= ratio;
        f.exit_pupil_diameter_mm *= ratio;
        f.film_distance_mm = traced->film_distance_mm();
    }
    out.json = numbers_json(f);
    out.json["length_mm"] = lens.length_mm();
    out.json["surfaces"] = lens.surfaces.size();
    out.json["stop_surface"] = lens.stop() + 1;
    out.json["wavelength_nm"] = nm;
    const double behind = lens.image_index(nm);
    out.json["image_index"] = behind;
    out.json["name"] = lens.name;
    out.json["stated_focal_length_mm"] =
        lens.stated_focal_length_mm ? json_number(*lens.stated_focal_length_mm) : nullptr;
    out.text = fmt::format(
        "{}: {}{}, {:.6g} mm long, stop at surface {}, {:.6g} nm\n"
        "EFL {:.8g} mm, BFL {:.8g} mm, FFL {:.8g} mm, f/{:.5g}\n"
        "entrance pupil {:.7g} mm at {:.7g} mm from the first surface\n"
        "exit pupil {:.7g} mm at {:.7g} mm from the last surface\n"
        "principal planes at {:.7g} mm (first surface) and {:.7g} mm (last surface); film at {:.7g} mm",
        o.lens.input, lens.name.empty() ? "" : lens.name + ", ", counted(lens.surfaces.size(), "surface"),
        lens.length_mm(), lens.stop() + 1, nm, f.efl_mm, f.bfl_mm, f.ffl_mm, f.f_number,
        f.entrance_pupil_diameter_mm, f.entrance_pupil_z_mm, f.exit_pupil_diameter_mm, f.exit_pupil_z_mm,
        f.front_principal_z_mm, f.rear_principal_z_mm, f.film_distance_mm);
    if (behind != 1) out.text += fmt::format("\nthe film lies in a medium of index {:.6g}", behind);
    if (lens.stated_focal_length_mm && nm == lens.wavelength_nm) {
        const double stated = *lens.stated_focal_length_mm;
        if (std::abs(f.efl_mm - stated) > 0.01 * std::abs(stated)) {
            out.warnings.push_back(
                {"stated_focal_length",
                 fmt::format("the file states a focal length of {:g} mm; its surfaces have {:.6g} mm", stated,
                             f.efl_mm)});
        }
    }
    if (o.film_width_mm && traced) {
        const double paraxial = 2 * degrees(0.5 * *o.film_width_mm / f.efl_mm);
        const auto exact = traced_field_deg(*traced, *o.film_width_mm);
        out.json["field_of_view_deg"] = paraxial;
        out.json["field_of_view_traced_deg"] = exact ? json_number(*exact) : nullptr;
        out.text += fmt::format(
            "\nfield of view over {:g} mm of film: {:.5g} degrees by the focal length, {} by its chief rays",
            *o.film_width_mm, paraxial, exact ? fmt::format("{:.5g}", *exact) : std::string("none"));
    }
    if (o.output) {
        const double edge = edge_tangent(*traced, lens, o.film_width_mm);
        const double depth = o.lens.focus_m.value_or(HUGE_VAL);
        write_drawing(*o.output, draw_section(lens_section(lens, *traced, depth, {0, 0.7 * edge, edge}, 7),
                                              lens, *traced));
        out.text += fmt::format("\n{}: cross-section with rays from 0, {:.3g} and {:.3g} degrees", *o.output,
                                degrees(0.7 * edge), degrees(edge));
    }
    return out;
}

}  // namespace postlens
