#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "apps/command.h"
#include "apps/numbers.h"
#include "core/counted.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/read_prescription.h"
#include "pictures/exr/exr_attributes.h"
#include "pictures/exr/exr_input.h"
#include "pictures/formats/picture_library.h"

namespace postlens {
namespace {

// Returns the number of layers in the file: layer 0 contains the visible surfaces, and the others contain
// surfaces hidden behind them. This number is not stored in the file. Therefore, all samples are read to find
// the largest layer.
std::int64_t layers_of(const SampleFileReader& file) {
    constexpr int rows = 64;
    std::uint32_t deepest = 0;
    RecordBand band;
    for (std::size_t i = 0; i < file.instants(); ++i) {
        for (int y = file.y_begin(); y < file.y_end(); y += rows) {
            file.read(y, std::min(y + rows, file.y_end()), band, i);
            for (const Record& r : band.records) deepest = std::max(deepest, r.layer);
        }
    }
    return std::int64_t{deepest} + 1;
}

CommandResult sample_file_info(const std::string& input, bool salvage) {
    const SampleFileReader file(input, damage_rule(salvage));
    const SampleHeader& h = file.header();
    float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
    for (std::size_t i = 0; i < file.instants(); ++i) {
        for (const ScanlineFacts& s : file.scanlines(i)) {
            nearest = std::min(nearest, s.nearest_z);
            farthest = std::max(farthest, s.farthest_z);
        }
    }
    const SufficientRange& range = h.sufficient;
    const std::int64_t layers = h.has_layers ? layers_of(file) : 1;
    nlohmann::ordered_json sufficient = {
        {"f_number", range.smallest_f_number ? json_number(*range.smallest_f_number) : nullptr},
        {"focus_m", range.nearest_focus_m ? nlohmann::ordered_json{json_number(*range.nearest_focus_m),
                                                                   json_number(*range.farthest_focus_m)}
                                          : nlohmann::ordered_json(nullptr)},
        {"shutter_s", range.shutter_open_s
                          ? nlohmann::ordered_json{*range.shutter_open_s, *range.shutter_close_s}
                          : nlohmann::ordered_json(nullptr)}};
    nlohmann::ordered_json ids = nlohmann::ordered_json::object();
    for (const auto& [id, name] : h.object_names) ids[std::to_string(id)] = name;
    CommandResult out;
    warn_of_missing_rows(file, out.warnings);
    out.json = {
        {"kind", "samples"},
        {"width", h.width},
        {"height", h.height},
        {"records", file.record_count()},
        {"bytes", file.file_bytes()},
        {"layers", layers},
        {"keys", file.instants()},
        {"key_times_s", h.key_times_s},
        {"ids", ids},
        {"focal_length_mm", h.focal_length_mm},
        {"film_distance_mm", h.film_distance_mm},
        {"pixel_pitch_mm", h.pixel_pitch_mm},
        {"f_number", h.f_number ? json_number(*h.f_number) : nullptr},
        {"focus_m", h.focus_m ? json_number(*h.focus_m) : nullptr},
        {"overscan_px", h.overscan_px},
        {"nearest_m", json_number(static_cast<double>(nearest))},
        {"farthest_m", farthest > 0 ? nlohmann::ordered_json(farthest) : nlohmann::ordered_json(nullptr)},
        {"projection", h.projection == Projection::perspective ? "perspective" : "orthographic"},
        {"time_s", h.time_s},
        {"subdivide", h.subdivide_levels},
        {"max_depth", h.max_depth},
        {"exposure_stops", h.exposure_stops},
        {"auto_exposure_stops", h.auto_exposure_stops ? nlohmann::ordered_json(*h.auto_exposure_stops)
                                                      : nlohmann::ordered_json(nullptr)},
        {"lumens_per_watt",
         h.lumens_per_watt ? nlohmann::ordered_json(*h.lumens_per_watt) : nlohmann::ordered_json(nullptr)},
        {"metres_per_unit",
         h.metres_per_unit ? nlohmann::ordered_json(*h.metres_per_unit) : nlohmann::ordered_json(nullptr)},
        {"refocus_matrices", h.has_w},
        {"refocus_bends", h.has_bend},
        {"marks", h.has_marks},
        {"scene", h.scene_name},
        {"scene_sha256", h.scene_sha256},
        {"moving_ids", h.moving_ids},
        {"sufficient", sufficient}};
    out.text = fmt::format(
        "{}: postlens samples, {}x{} px + {} px overscan, {}, {}\n"
        "scene {}; depths {:.4g} to {:.4g} m; {}; subdivision to level {}; paths of up to {}\n"
        "film distance {:.5g} mm, pixel pitch {:.5g} mm, F {:.5g} mm",
        input, h.width, h.height, h.overscan_px, counted(file.record_count(), "record"),
        megabytes(static_cast<double>(file.file_bytes())), h.scene_name, nearest, farthest,
        counted(h.object_names.size(), "object"), h.subdivide_levels, counted(h.max_depth, "node"),
        h.film_distance_mm, h.pixel_pitch_mm, h.focal_length_mm);
    if (h.exposure_stops != 0) out.text += fmt::format("\nexposure {:.4g} stops", h.exposure_stops);
    if (layers > 1) out.text += "\n" + counted(layers, "layer");
    if (file.instants() > 1) {
        out.text += fmt::format("\nfurther instants: {} s", fmt::join(h.key_times_s, ", "));
    }
    if (range.smallest_f_number) {
        out.text += fmt::format("\nsuffices for f-numbers from {} on", *range.smallest_f_number);
    }
    if (range.shutter_open_s) {
        out.text += fmt::format("\nsuffices for a shutter open from {} s to {} s", *range.shutter_open_s,
                                *range.shutter_close_s);
    }
    return out;
}

CommandResult scene_info(const std::string& input) {
    const Scene scene = read_scene(input);
    std::size_t moving = 0, triangles = 0;
    std::set<const Mesh*> meshes;
    std::optional<TimeSpan> motion;
    const auto add_motion = [&](const std::vector<TransformKey>& keys) {
        if (keys.empty()) return;
        if (!motion) motion = TimeSpan{keys.front().time_s, keys.back().time_s};
        motion->open_s = std::min(motion->open_s, keys.front().time_s);
        motion->close_s = std::max(motion->close_s, keys.back().time_s);
    };
    for (const Object& o : scene.objects) {
        moving += o.keys.empty() ? 0 : 1;
        add_motion(o.keys);
        const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&o.shape);
        if (mesh && meshes.insert(mesh->get()).second) triangles += (*mesh)->triangles.size();
    }
    std::set<const Texture*> textures;
    for (const Material& m : scene.materials) {
        for (const Texture* t : {m.colour_texture.get(), m.emission_texture.get()}) {
            if (t) textures.insert(t);
        }
    }
    for (const Camera& c : scene.cameras) add_motion(c.keys);
    for (const Light& l : scene.lights) add_motion(l.keys);
    std::vector<std::string> cameras;
    for (const Camera& c : scene.cameras) cameras.push_back(c.name);
    const CameraModel camera(find_camera(scene, ""), scene.time_s);
    CommandResult out;
    for (const std::string& note : scene.notes) out.warnings.push_back({"scene", note});
    out.json = {{"kind", "scene"},
                {"width", camera.width},
                {"height", camera.height},
                {"name", scene.name},
                {"objects", scene.objects.size()},
                {"moving", moving},
                {"meshes", meshes.size()},
                {"triangles", triangles},
                {"materials", scene.materials.size()},
                {"textures", textures.size()},
                {"motion_s", motion ? nlohmann::ordered_json{motion->open_s, motion->close_s}
                                    : nlohmann::ordered_json(nullptr)},
                {"lights", scene.lights.size()},
                {"cameras", cameras},
                {"focal_length_mm", camera.film_distance_mm},
                {"film_distance_mm", camera.film_distance_mm},
                {"scene_sha256", scene.sha256}};
    out.text = fmt::format("{}: scene {}, {} ({} moving), {}, {}, {}; {}x{} px", input, scene.name,
                           counted(scene.objects.size(), "object"), moving,
                           counted(scene.materials.size(), "material"), counted(scene.lights.size(), "light"),
                           counted(scene.cameras.size(), "camera"), camera.width, camera.height);
    if (!meshes.empty()) {
        out.text += fmt::format("\n{} {} of {}", meshes.size(), meshes.size() == 1 ? "mesh" : "meshes",
                                counted(triangles, "triangle"));
    }
    if (!textures.empty()) out.text += fmt::format("\n{}", counted(textures.size(), "texture"));
    if (motion) out.text += fmt::format("\nmotion from {:.6g} to {:.6g} s", motion->open_s, motion->close_s);
    if (scene.cameras.size() > 1) out.text += fmt::format("\ncameras: {}", fmt::join(cameras, ", "));
    return out;
}

CommandResult lens_info(const std::string& input) {
    CommandResult out;
    const Prescription lens = read_lens(input, out.warnings);
    const FirstOrder f = first_order(lens);
    out.json = {{"kind", "lens"},
                {"name", lens.name},
                {"surfaces", lens.surfaces.size()},
                {"stop_surface", lens.stop() + 1},
                {"focal_length_mm", json_number(f.efl_mm)},
                {"film_distance_mm", json_number(f.film_distance_mm)},
                {"f_number", json_number(f.f_number)},
                {"wavelength_nm", lens.wavelength_nm}};
    out.text =
        fmt::format("{}: lens prescription{}, {}, EFL {:.6g} mm, f/{:.4g} (postlens lens show says more)",
                    input, lens.name.empty() ? "" : " " + lens.name, counted(lens.surfaces.size(), "surface"),
                    f.efl_mm, f.f_number);
    return out;
}

CommandResult image_info(const std::string& input) {
    check_exr_headers(input);
    std::string problem;
    const auto file = picture_library().open(input, problem);
    if (!file) {
        fail(ExitCode::invalid_input,
             "{}: not a file that postlens knows (expected a scene, a lens, a sample file or an image)",
             input);
    }
    const PictureLayout& layout = file->layout();
    CommandResult out;
    out.json = {{"kind", "image"},         {"width", layout.width},       {"height", layout.height},
                {"format", layout.format}, {"channels", layout.channels}, {"deep", layout.deep}};
    out.text = fmt::format("{}: {} image, {}x{} px, {}{}", input, layout.format, layout.width, layout.height,
                           counted(layout.channels.size(), "channel"), layout.deep ? ", deep" : "");
    return out;
}

}  // namespace

CommandResult run_info(const InfoOptions& options) {
    const std::string& input = options.input;
    static_cast<void>(InputFile(input));  // throws if it is not a file, or cannot be read
    if (options.salvage) return sample_file_info(input, true);
    if (is_prescription(input)) return lens_info(input);
    if (is_scene_file(input)) return scene_info(input);
    if (SampleFileReader::is_sample_file(input)) return sample_file_info(input, false);
    if (is_foreign(input)) return foreign_info(input);
    return image_info(input);
}

}  // namespace postlens
