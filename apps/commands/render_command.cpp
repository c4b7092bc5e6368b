#include <cmath>
#include <filesystem>

#include "apps/command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/scene_input.h"
#include "apps/share.h"
#include "core/counted.h"
#include "lens/prescription/read_prescription.h"
#include "pictures/aperture_file.h"
#include "pictures/crop.h"
#include "tracer/camera_model.h"
#include "tracer/exposure.h"
#include "tracer/trace.h"

namespace postlens {

ShutterCurve shutter_curve(const std::string& word) {
    if (word == "box") return ShutterCurve::box();
    if (word == "triangle") return ShutterCurve::triangle();
    std::error_code none;
    if (!std::filesystem::exists(word, none)) {
        fail(ExitCode::invalid_input,
             "--shutter-curve: no such file (got {}; expected box, triangle or a file)", word);
    }
    return ShutterCurve::read(word);
}

namespace {

const char* name(SamplerKind kind) {
    switch (kind) {
        case SamplerKind::grid:
            return "grid";
        case SamplerKind::jittered:
            return "jittered";
        case SamplerKind::random:
            return "random";
        case SamplerKind::poisson:
            return "poisson";
        case SamplerKind::sobol:
            break;
    }
    return "sobol";
}

nlohmann::ordered_json shutter_json(const RenderSettings& s) {
    if (!s.shutter) return nullptr;
    return {s.shutter->open_s, s.shutter->close_s};
}

}  // namespace

CommandResult run_render(const RenderOptions& options) {
    CommandResult out;
    RenderSettings settings = options.settings;
    settings.made_by = options.made_by;
    settings.focal_length_mm = options.lens.focal_length_mm;
    settings.f_number = options.lens.f_number;
    settings.focus_m = options.lens.focus_m;
    settings.focus_at = options.lens.focus_at;
    settings.framing = options.lens.framing;
    if (options.impulse.kind == ImpulseKind::lens) {
        check_impulse(options.impulse);
        settings.prescription = std::make_shared<Prescription>(read_lens(options.impulse.file, out.warnings));
    } else if (options.impulse.kind == ImpulseKind::diffraction) {
        fail(ExitCode::wrong_arguments,
             "--impulse: rays do not diffract (got {}; expected disc, polygon, image or lens)",
             impulse_text(options.impulse));
    } else {
        settings.aperture = std::make_shared<Aperture>(read_aperture(options.impulse));
    }
    settings.curve = shutter_curve(options.curve);
    std::vector<std::filesystem::path> written{options.output};
    if (settings.halves) {
        for (const auto& half : half_paths(options.output)) written.push_back(half);
    }
    Scene scene = read_scene_of_command(options.scene, options.units, written, out);
    expose(scene, exposure_of_scene(options.exposure, scene, settings.camera_name, settings.camera));
    const bool to_file = !options.output.empty();
    if (std::optional<SharedWork> shared = options.shared) {
        if (options.share_by_samples) {
            settings.sample_share = {shared->share.index, shared->share.count};
            shared->mark = mark_of(*shared, settings.crop);
        } else {
            const CameraModel camera(find_camera(scene, settings.camera_name), 0, settings.camera);
            take_share(shared, settings.crop, camera.width, camera.height);
        }
        settings.part_mark = shared->mark;
    }
    if (!to_file && settings.resume) {
        fail(ExitCode::wrong_arguments, "--resume: goes with --output (got it alone)");
    }
    RenderResult r =
        to_file ? render_to_file(scene, settings, options.output) : render_picture(scene, settings);
    if (r.motion_error_px > MotionAccuracy().tolerance_px) {
        out.warnings.push_back(
            {"motion",
             fmt::format("a mesh moves too fast for Embree's time steps: its path errs by up to {:.2g} px",
                         r.motion_error_px)});
    }
    if (settings.halves && settings.sampler == SamplerKind::grid) {
        out.warnings.push_back(
            {"halves", "both halves have the grid's own error, which their difference does not show"});
    }
    if (settings.resume && !r.resumed) {
        out.warnings.push_back({"resume", fmt::format("there was nothing to go on from ({} is missing)",
                                                      partial_path(options.output).string())});
    }
    out.json = {{"rays", rays_json(r.rays)},
                {"spp", settings.spp},
                {"spp_resumed", r.spp_resumed},
                {"sampler", name(settings.sampler)},
                {"seed", settings.seed},
                {"focus_m", json_number(r.focus_m)},
                {"focal_length_mm", r.focal_length_mm},
                {"f_number", json_number(r.f_number)},
                {"impulse", impulse_text(options.impulse)},
                {"shutter_s", shutter_json(settings)},
                {"seconds_render", r.seconds_render}};
    if (settings.halves && to_file && !settings.sample_share) {
        const auto paths = half_paths(options.output);
        out.json["halves"] = {paths[0].string(), paths[1].string()};
    }
    const double rate = static_cast<double>(r.rays.eye) / std::max(r.seconds_render, 1e-9) / 1e6;
    out.text = fmt::format(
        "{}: {}x{} px, {} a pixel ({}), {}, focus {:.4g} m, {:.3g} s, {:.3g} million samples/s",
        options.output, r.image.width, r.image.height, counted(settings.spp, "sample"),
        name(settings.sampler),
        std::isfinite(r.f_number) ? fmt::format("F = {:.4g} mm, f/{:.4g}", r.focal_length_mm, r.f_number)
                                  : std::string("pinhole"),
        r.focus_m, r.seconds_render, rate);
    report_picture(r.image, options.output, settings.crop, out);
    if (!to_file) {
        out.pictures.push_back(cut(r.image, settings.crop));
        if (settings.halves) {
            for (const Image& half : r.halves) out.pictures.push_back(cut(half, settings.crop));
        }
    }
    return out;
}

}  // namespace postlens
