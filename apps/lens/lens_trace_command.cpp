#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/lens/lens_command.h"
#include "apps/lens/lens_drawing.h"
#include "apps/lens/response_picture.h"
#include "apps/numbers.h"
#include "core/files/output_file.h"
#include "core/job.h"
#include "lens/prescription/read_prescription.h"
#include "lens/traced/lens_models.h"
#include "lens/traced/mesh_response.h"

namespace postlens {
namespace {

using glm::dvec2;

constexpr int curve_points = 25;
constexpr int impulse_nodes = 257;

struct FieldResult {
    double deg = 0, tangent = 0;
    PupilMesh mesh;
    double rms_mm = 0, largest_mm = 0, transmission = 0;
    dvec2 centroid_mm{0};
    Spot spot;
};

double tangent_of(double deg) {
    return std::tan(deg * std::numbers::pi / 180);
}

bool is_csv(const std::string& path) {
    return path.ends_with(".csv") || path.ends_with(".CSV");
}

void check_path(const std::string& path) {
    if (!is_csv(path)) check_drawing_path(path, "csv, ");
}

FieldResult trace_field(const TracedLens& traced, double depth_m, double deg, int rays, double axis_mm2) {
    FieldResult out;
    out.deg = deg;
    out.tangent = tangent_of(deg);
    const bool any = traced.impulse(depth_m, {0, out.tangent}, rays, out.mesh);
    out.spot.title = fmt::format("{:.4g} degrees", deg);
    if (!any) return out;
    double sum = 0;
    for (std::size_t k = 0; k < out.mesh.passes.size(); ++k) {
        if (out.mesh.passes[k] == 0) continue;
        const auto w = static_cast<double>(out.mesh.weight[k]);
        out.centroid_mm += w * out.mesh.film_mm[k];
        sum += w;
    }
    out.centroid_mm /= sum;
    double square = 0;
    for (std::size_t k = 0; k < out.mesh.passes.size(); ++k) {
        if (out.mesh.passes[k] == 0) continue;
        const dvec2 p = out.mesh.film_mm[k];
        square +=
            static_cast<double>(out.mesh.weight[k]) * glm::dot(p - out.centroid_mm, p - out.centroid_mm);
        out.largest_mm = std::max(out.largest_mm, glm::length(p));
        out.spot.points_mm.push_back(-p);  // the lens inverts its image, but the diagram is upright
    }
    out.rms_mm = std::sqrt(square / sum);
    out.spot.rms_mm = out.rms_mm;
    out.transmission = axis_mm2 > 0 ? out.mesh.passing_area_mm2 / axis_mm2 : 0;
    return out;
}

std::string spots_csv(const std::vector<FieldResult>& fields) {
    std::string out = "field_deg,pupil_x_mm,pupil_y_mm,passes,film_x_mm,film_y_mm\n";
    for (const FieldResult& f : fields) {
        for (std::size_t k = 0; k < f.mesh.passes.size(); ++k) {
            constexpr std::size_t often = 4096;  // number of lines between two tests for cancellation
            if (k % often == 0) throw_if_interrupted();
            const dvec2 film = f.mesh.film_mm[k] + (f.mesh.passes[k] != 0 ? f.mesh.chief_film_mm : dvec2(0));
            out += fmt::format("{},{},{},{},{},{}\n", f.deg, f.mesh.pupil_mm[k].x, f.mesh.pupil_mm[k].y,
                               static_cast<int>(f.mesh.passes[k]), film.x, film.y);
        }
    }
    return out;
}

// Returns the distance, in mm, from the centre of the film to the chief ray's point on the film, or NaN.
// `tangent` is the tangent of the field angle.
double chief_height(const TracedLens& traced, double depth_m, double tangent) {
    const auto aim = traced.aim_at_stop(depth_m, {0, tangent});
    if (!aim) return NAN;
    LensRay ray = traced.object_ray(depth_m, {0, tangent}, *aim);
    if (!traced.stack().forward(ray, Apertures::ignored).passes()) return NAN;
    return 0 - traced.on_film(ray).y;
}

double irradiance(const TracedLens& traced, double film_mm) {
    constexpr int nodes = 96;
    double sum = 0;
    SceneRay ray;
    for (int j = 0; j < nodes; ++j) {
        for (int i = 0; i < nodes; ++i) {
            const dvec2 uv((i + 0.5) / nodes, (j + 0.5) / nodes);
            if (traced.scene_ray({0, -film_mm}, uv, ray)) sum += ray.weight;
        }
    }
    return sum / (nodes * nodes);
}

struct FieldCurves {
    std::vector<double> deg, film_mm, distortion_percent, pupil_share, illumination;
};

/// Returns the area of the entrance pupil, in mm^2, that transmits light from a point on the axis. Areas for
/// points off the axis are stated relative to it.
double axis_area_mm2(const TracedLens& traced, double depth_m, int rays) {
    PupilMesh mesh;
    return traced.impulse(depth_m, dvec2(0), rays, mesh) ? mesh.passing_area_mm2 : 0;
}

FieldCurves field_curves(const TracedLens& traced, double depth_m, double film_radius_mm) {
    constexpr int rays = 129;
    FieldCurves out;
    // `scale` is the image height, in mm, divided by the tangent of the field angle, for a lens without
    // distortion. It is measured at a very small angle, because close to its axis no lens has distortion.
    constexpr double small = 1e-4;
    const double scale = chief_height(traced, depth_m, small) / small;
    double edge = film_radius_mm / scale;
    try {
        edge = lens_model_range(traced, 1, 2, film_radius_mm, 2).tangents.back();
    } catch (const Error&) {
        edge = std::min(edge, 1.5);  // no chief ray reaches the film's edge, so keep the paraxial estimate
    }
    PupilMesh mesh;
    const double axis_mm2 = axis_area_mm2(traced, depth_m, rays);
    for (int i = 0; i < curve_points; ++i) {
        const double tangent = edge * i / (curve_points - 1);
        const double height = chief_height(traced, depth_m, tangent);
        out.deg.push_back(std::atan(tangent) * 180 / std::numbers::pi);
        out.film_mm.push_back(height);
        out.distortion_percent.push_back(tangent > 0 ? 100 * (height / (scale * tangent) - 1) : 0);
        const bool any = traced.impulse(depth_m, {0, tangent}, rays, mesh);
        out.pupil_share.push_back(any && axis_mm2 > 0 ? mesh.passing_area_mm2 / axis_mm2 : 0);
        out.illumination.push_back(
            std::isfinite(height) ? irradiance(traced, std::min(height, film_radius_mm)) : NAN);
    }
    return out;
}

void write_curves(const std::string& path, const FieldCurves& c) {
    if (is_csv(path)) {
        std::string text = "field_deg,film_mm,distortion_percent,pupil_share,relative_illumination\n";
        for (std::size_t i = 0; i < c.deg.size(); ++i) {
            text += fmt::format("{},{},{},{},{}\n", c.deg[i], c.film_mm[i], c.distortion_percent[i],
                                c.pupil_share[i], c.illumination[i]);
        }
        write_file(path, text);
        return;
    }
    write_drawing(path,
                  draw_curves({{"Illumination of a uniform scene", "of the centre's", c.deg, c.illumination},
                               {"Entrance pupil's area", "of the centre's", c.deg, c.pupil_share},
                               {"Distortion", "%", c.deg, c.distortion_percent}},
                              "field, degrees"));
}

// Writes the impulse responses of all field points side by side, each centred on its chief ray.
void write_impulse(const std::string& path, const TracedLens& traced, double depth_m,
                   const std::vector<FieldResult>& fields, double pitch_mm) {
    std::vector<ResponseGrid> grids;
    int half = 1;
    PupilMesh mesh;
    for (const FieldResult& f : fields) {
        (void)traced.impulse(depth_m, {0, f.tangent}, impulse_nodes, mesh);
        grids.push_back(mesh_response(mesh, pitch_mm));
        const ResponseGrid& g = grids.back();
        half = std::max({half, -g.x_begin, -g.y_begin, g.x_begin + g.width, g.y_begin + g.height});
    }
    const int side = 2 * half + 1;
    Image image(side * static_cast<int>(grids.size()), side);
    for (std::size_t k = 0; k < grids.size(); ++k) {
        const ResponseGrid& g = grids[k];
        for (int j = 0; j < g.height; ++j) {
            for (int i = 0; i < g.width; ++i) {
                float* p =
                    image.pixel(static_cast<int>(k) * side + half + g.x_begin + i, half + g.y_begin + j);
                std::fill(p, p + 3, static_cast<float>(g.at(i, j)));
            }
        }
    }
    write_image(path, image);
}

}  // namespace

CommandResult run_lens_trace(const LensTraceOptions& o) {
    for (const double deg : o.fields_deg) {
        if (!(std::abs(deg) <= 89)) {
            fail(ExitCode::wrong_arguments, "--fields: out of range (got {} degrees; expected -89 to 89)",
                 deg);
        }
    }
    if (o.output) check_path(*o.output);
    if (o.curves) check_path(*o.curves);
    if (o.impulse) check_exr_path(*o.impulse, "responses");
    CommandResult out;
    const Prescription lens = read_lens(o.lens.input, out.warnings);
    const TracedLens traced(lens, traced_lens_settings(o.lens, 0.5 * o.film_width_mm));
    const double depth = o.depth_m.value_or(o.lens.focus_m.value_or(HUGE_VAL));
    check_depth(o.depth_m ? "--depth" : "--focus", depth, traced);
    std::vector<double> degs = o.fields_deg;
    if (degs.empty()) {
        const double edge =
            std::atan(0.5 * o.film_width_mm / traced.first_order().efl_mm) * 180 / std::numbers::pi;
        degs = {0, 0.5 * edge, edge};
    }
    const double axis_mm2 = axis_area_mm2(traced, depth, o.rays);
    std::vector<FieldResult> fields;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    out.text = fmt::format("{}: f/{:.4g}, film {:.6g} mm behind the last surface, object at {}", o.lens.input,
                           traced.f_number(), traced.film_distance_mm(),
                           std::isinf(depth) ? "infinity" : fmt::format("{:g} m", depth));
    const double scale = chief_height(traced, depth, 1e-4) / 1e-4;
    for (const double deg : degs) {
        fields.push_back(trace_field(traced, depth, deg, o.rays, axis_mm2));
        const FieldResult& f = fields.back();
        const double height = chief_height(traced, depth, f.tangent) + 0.0;  // turns -0 into 0
        const double distortion = f.tangent != 0 ? 100 * (height / (scale * f.tangent) - 1) : 0;
        list.push_back({{"field_deg", deg},
                        {"film_mm", json_number(height)},
                        {"rms_radius_um", 1000 * f.rms_mm},
                        {"largest_radius_um", 1000 * f.largest_mm},
                        {"centroid_um", {-1000 * f.centroid_mm.x, -1000 * f.centroid_mm.y}},
                        {"pupil_share", f.transmission},
                        {"distortion_percent", json_number(distortion)}});
        if (f.transmission == 0)
            out.warnings.push_back(
                {"no_light", fmt::format("no light from {:g} degrees reaches the film", deg)});
        const bool has_chief = std::isfinite(height);
        out.text += fmt::format(
            "\n{:7.3f} degrees: {}, RMS radius {:.4g} um, {:.3g} of the axis's pupil{}", deg,
            has_chief ? fmt::format("chief ray at {:.6g} mm", height) : "no chief ray", 1000 * f.rms_mm,
            f.transmission, has_chief ? fmt::format(", distortion {:.3g} %", distortion) : "");
    }
    out.json = {{"f_number", traced.f_number()},
                {"film_distance_mm", traced.film_distance_mm()},
                {"extension_mm", traced.extension_mm()},
                {"depth_m", json_number(depth)},
                {"axial_irradiance_sr", traced.axial_irradiance_sr()},
                {"fields", list}};
    std::vector<Spot> spots;
    spots.reserve(fields.size());
    for (const FieldResult& f : fields) spots.push_back(f.spot);
    if (o.output && is_csv(*o.output)) write_file(*o.output, spots_csv(fields));
    if (o.output && !is_csv(*o.output)) write_drawing(*o.output, draw_spots(spots));
    if (o.curves) write_curves(*o.curves, field_curves(traced, depth, 0.5 * o.film_width_mm));
    if (o.impulse) write_impulse(*o.impulse, traced, depth, fields, o.pixel_pitch_um * 1e-3);
    return out;
}

}  // namespace postlens
