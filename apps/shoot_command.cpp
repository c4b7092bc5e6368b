#include <cmath>

#include "apps/command.h"
#include "motionblur/paths_file.h"
#include "tracer/scene.h"

namespace postlens {
namespace {

// Blue: scattered, grey: light field, red: traced again; as bright as the picture.
void write_explanation(const std::string& path, const HybridResult& r) {
    Image out(r.focus.image.width, r.focus.image.height);
    constexpr float tint[3][3] = {{1, 1, 1}, {0.35F, 0.6F, 1.6F}, {2, 0.3F, 0.2F}};
    for (std::size_t k = 0; k < r.what.size(); ++k) {
        const float* rgb = r.focus.image.rgb.data() + 3 * k;
        const float grey =
            0.1F + 0.6F * std::min(1.0F, 0.2126F * rgb[0] + 0.7152F * rgb[1] + 0.0722F * rgb[2]);
        for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * k + c] = grey * tint[r.what[k]][c];
    }
    write_image(path, out);
}

}  // namespace

HybridResult run_hybrid(const SampleFileReader& file, HybridSettings settings, const RetraceOptions& retrace,
                        CommandResult& out) {
    if (retrace.explain) check_image_path(*retrace.explain);
    if (retrace.spp < 1) {
        fail(ExitCode::wrong_arguments, "--retrace-spp: out of range (got {}; expected 1 or more)",
             retrace.spp);
    }
    std::optional<Scene> scene;
    if (retrace.scene) {
        scene = read_scene(*retrace.scene, {.metres_per_unit = retrace.metres_per_unit.value_or(1)});
        for (const std::string& note : scene->notes) out.warnings.push_back({"scene", note});
        settings.scene = &*scene;
    }
    settings.retrace_spp = retrace.spp;
    HybridResult result = hybrid_picture(file, settings);
    if (retrace.explain) write_explanation(*retrace.explain, result);
    return result;
}

nlohmann::ordered_json shares_json(const HybridResult& r) {
    return {{"scattered_share", r.scattered_share},
            {"insufficient_share", r.wanted_share},
            {"rays", rays_json(r.rays)}};
}

CommandResult run_shoot(const ShootOptions& options) {
    const FocusOptions& o = options.focus;
    check_image_path(o.output);
    const SampleFileReader file(o.input);
    const SampleHeader& h = file.header();
    const ResolvedLens lens = resolve_lens(o.lens, file);
    const Exposure exposure = resolve_exposure(options.shutter, h);
    check_exposure(exposure);
    const FrameMotion motion =
        motion_of(h, options.paths ? read_paths(*options.paths) : std::vector<ObjectPath>());
    CommandResult out;
    const HybridResult result = run_hybrid(file,
                                           {.focus = {.lens = lens.lens,
                                                      .focus_distance_m = lens.focus_m,
                                                      .framing = o.lens.framing,
                                                      .method = o.method,
                                                      .impulse = o.impulse,
                                                      .views = o.views},
                                            .motion = &motion,
                                            .shutter = TimeSpan{exposure.open_s, exposure.close_s},
                                            .curve = shutter_curve(options.curve)},
                                           o.retrace, out);
    write_image(o.output, result.focus.image);

    check_sufficient(h, lens, out.warnings);
    check_sufficient(h, exposure, out.warnings);
    for (const FocusWarning& w : result.focus.warnings) out.warnings.push_back({w.code, w.text, w.share});
    if (o.strict && !out.warnings.empty()) out.exit_code = ExitCode::shortfall;
    const char* method = o.method == FocusMethod::hybrid ? "hybrid" : "lightfield";
    out.json = {{"method", method},
                {"views", o.views},
                {"depths", nullptr},
                {"predicted_db", nullptr},
                {"retraced_share", result.retraced_share},
                {"focus_m", json_number(lens.focus_m)},
                {"focal_length_mm", lens.lens.focal_length_mm},
                {"f_number", json_number(lens.lens.f_number)},
                {"shutter_open_s", exposure.open_s},
                {"shutter_close_s", exposure.close_s},
                {"instants", file.instants()}};
    out.json.update(shares_json(result));
    out.text = fmt::format(
        "{}: {}x{} px, {}, {} views, F = {:.4g} mm, f/{:.4g}, focus {:.4g} m, shutter {:.6g} to {:.6g} s, "
        "{:.1f} % "
        "traced again",
        o.output, result.focus.image.width, result.focus.image.height, method, o.views,
        lens.lens.focal_length_mm, lens.lens.f_number, lens.focus_m, exposure.open_s, exposure.close_s,
        100 * result.retraced_share);
    return out;
}

}  // namespace postlens
