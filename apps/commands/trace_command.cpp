#include <algorithm>
#include <cmath>

#include "apps/command.h"
#include "apps/numbers.h"
#include "apps/scene_input.h"
#include "apps/share.h"
#include "core/counted.h"
#include "core/files/disk.h"
#include "planner/trace_plan.h"
#include "tracer/exposure.h"
#include "tracer/recording/key_instants.h"
#include "tracer/recording/light_keys.h"
#include "tracer/recording/recorded_motion.h"
#include "tracer/shading/averaged_shading.h"

namespace postlens {

namespace {

// Warns if shapes with the same id move differently, because a sample file stores one motion per id.
void warn_of_motion(const Scene& scene, CommandResult& out) {
    const std::vector<std::uint32_t> apart = ids_that_move_apart(scene);
    if (apart.empty()) return;
    std::string ids;
    constexpr std::size_t most_named = 8;
    for (std::size_t i = 0; i < std::min(apart.size(), most_named); ++i) {
        ids += (i == 0 ? "" : ", ") + std::to_string(apart[i]);
    }
    if (apart.size() > most_named) ids += ", ...";
    out.warnings.push_back(
        {"motion",
         fmt::format("shapes of one id move differently; the file says how the first one moves (ids {})",
                     ids)});
}

// Warns if the user has chosen too few recorded instants (--keys) for the motion while the shutter is open.
void warn_of_keys(const Scene& scene, const TraceSettings& settings, CommandResult& out) {
    if (!settings.for_shutter || !settings.keys) return;
    const int keys = *settings.keys;
    const Camera& camera = find_camera(scene, settings.camera_name);
    const std::string recorded =
        keys == 1 ? "only one instant is recorded" : fmt::format("only {} instants are recorded", keys);
    const double sweep_degrees = view_sweep_degrees(scene, camera, *settings.for_shutter);
    if (keys_for_sweep(sweep_degrees, settings.degrees_per_key) > keys) {
        out.warnings.push_back(
            {"turns",
             fmt::format("an object turns by {:.3g} degrees relative to the camera while the shutter is "
                         "open, but {} (expected --keys auto)",
                         sweep_degrees, recorded)});
    }
    const double time_s = settings.time_s.value_or(scene.time_s);
    if (keys_for_visits(scene, camera, settings.camera, time_s, *settings.for_shutter, keys) > keys) {
        out.warnings.push_back(
            {"visit",
             fmt::format("an object is in the frame, large or around the camera only between the recorded "
                         "instants, as {} (expected --keys auto)",
                         recorded)});
    }
    if (keys == 1) return;
    const LightKeys light =
        light_keys(scene, camera, settings.camera, time_s, *settings.for_shutter, settings.light_db,
                   {settings.whitted.max_depth, settings.whitted.min_contribution});
    if (light.keys > keys) {
        out.warnings.push_back(
            {"light", fmt::format("light changes while the shutter is open, but {} (expected --keys auto)",
                                  recorded)});
    }
}

void check_room(std::uint64_t bytes, const std::string& output) {
    require_disk(bytes, free_disk_bytes(output), output,
                 "expected enough, a smaller --size or --subdivide, or --force to try all the same");
}

// Returns true if the disk has far more free space than a trace needs.
bool has_ample_room(const Scene& scene, const TraceSettings& settings, const std::string& output) {
    constexpr double ample_bytes_per_px = 16384;
    const CameraModel camera(find_camera(scene, settings.camera_name), scene.time_s, settings.camera);
    constexpr double widest_usual_overscan_px = 256;
    const double overscan = settings.overscan_auto ? widest_usual_overscan_px : settings.overscan_px;
    const double px = (camera.width + 2 * overscan) * (camera.height + 2 * overscan);
    const double instants = 1 + settings.keys.value_or(static_cast<int>(SampleHeader::most_keys));
    return px * instants * ample_bytes_per_px <= static_cast<double>(free_disk_bytes(output));
}

}  // namespace

nlohmann::ordered_json rays_json(const RayCounts& rays) {
    return {{"eye", rays.eye},
            {"eye_hits", rays.eye_hits},
            {"reflect", rays.reflect},
            {"refract", rays.refract},
            {"shadow", rays.shadow}};
}

CommandResult run_trace(const TraceOptions& options) {
    check_exr_path(options.output, "records");
    CommandResult out;
    Scene scene = read_scene_of_command(options.scene, options.units, {options.output}, out);
    warn_of_motion(scene, out);
    TraceSettings settings = options.settings;
    // `--subdivide` clears this flag, because it overrides `--for-rays`.
    if (options.for_rays && settings.subdivide_for_lens) {
        settings.subdivide_for_lens = false;
        settings.subdivision.levels = TraceSettings::ray_levels;
    }
    if (options.for_rays) {
        settings.degrees_per_key = TraceSettings::ray_degrees_per_key;
        settings.light_db = TraceSettings::ray_light_db;
        settings.narrow_strip_px = TraceSettings::ray_narrow_strip_px;
    }
    settings.made_by = options.made_by;
    if (const auto& shared = options.shared) {
        settings.share = shared->share;
        settings.made_by = mark_of(*shared, std::nullopt);
    }
    settings.auto_exposure_stops = auto_exposure_stops(scene, settings.camera_name, settings.camera);
    expose(scene,
           options.exposure.automatic ? *settings.auto_exposure_stops : options.exposure.stops.value_or(0));
    std::optional<std::uint64_t> expected_bytes;
    nlohmann::ordered_json plan = nullptr;
    if (options.plan) {
        require_trace_memory(scene, settings, options.output);  // the preview pass needs much memory as well
        const TracePlan p = plan_trace(scene, settings, options.target_db, options.for_rays);
        settings = p.settings;
        plan = {{"subdivide", p.levels}, {"floor_db", p.floor_db}, {"floors_db", p.floors_db},
                {"records", p.records},  {"bytes", p.bytes},       {"seconds", p.seconds}};
        out.text = p.text + "\n";
        expected_bytes = static_cast<std::uint64_t>(p.bytes);
        if (!options.force) check_room(*expected_bytes, options.output);
        if (!p.met) {
            out.warnings.push_back(
                {"target", fmt::format("no subdivision leaves room for {:.1f} dB (expected {:.1f} "
                                       "dB from the finest)",
                                       options.target_db, p.floor_db)});
            out.exit_code = ExitCode::shortfall;
        }
    }
    warn_of_keys(scene, settings, out);
    if (!options.plan && !options.force && !has_ample_room(scene, settings, options.output)) {
        settings.on_expected_bytes = [&](std::uint64_t bytes) {
            expected_bytes = bytes;
            check_room(bytes, options.output);
        };
    }
    const TraceResult r = trace_to_file(scene, settings, options.output);
    if (r.too_narrow_objects > 0) {
        out.warnings.push_back(
            {"narrow",
             fmt::format("{} may be so narrow as to fall between the corners of cells{}",
                         counted(r.too_narrow_objects, "object"),
                         settings.subdivision.levels == 0 ? ", which --subdivide 1 or more looks for" : "")});
    }
    out.json = {{"records", r.records},
                {"bytes", r.bytes},
                {"expected_bytes",
                 expected_bytes ? nlohmann::ordered_json(*expected_bytes) : nlohmann::ordered_json(nullptr)},
                {"rays", rays_json(r.rays)},
                {"exposure_stops", scene.exposure_stops},
                {"auto_exposure_stops", *settings.auto_exposure_stops},
                {"overscan_px", r.overscan_px},
                {"keys", r.keys},
                {"instants_s", r.instants_s},
                {"keys_sweep_degrees", r.keys_sweep_degrees ? json_number(*r.keys_sweep_degrees) : nullptr},
                {"keys_reason", r.keys_sweep_degrees ? nlohmann::ordered_json(r.keys_reason) : nullptr}};
    const AveragedShading averaged = averaged_shading(scene);
    out.json["averaged"] = {{"materials", averaged.materials}, {"lights", averaged.lights}};
    if (settings.share && settings.share->count > 1 && averaged.materials > 0) {
        out.warnings.push_back(
            {"share",
             "the merged trace differs from the undivided one by the noise of the means over lobes, "
             "as neighbouring samples share the rays of these means"});
    }
    if (options.plan) out.json["plan"] = plan;
    out.json["rays"]["hidden"] = r.rays.hidden;
    out.json["rays"]["lens"] = r.rays.lens;
    out.text += fmt::format("{}: {}, {}; {} eye, {} reflected, {} refracted, {} shadow rays", options.output,
                            counted(r.records, "record"), megabytes(static_cast<double>(r.bytes)), r.rays.eye,
                            r.rays.reflect, r.rays.refract, r.rays.shadow);
    if (r.rays.hidden > 0) out.text += fmt::format(", {} behind surfaces", r.rays.hidden);
    if (averaged.any()) {
        out.text += fmt::format(
            "\naveraged in the surfaces' own records: the lobes of {} of {}, where wider than the lens, and "
            "{} "
            "of {}",
            averaged.materials, counted(scene.materials.size(), "material"), averaged.lights,
            counted(scene.lights.size(), "light"));
    }
    if (r.keys_sweep_degrees) {
        out.text += fmt::format("\n{}, as {}", counted(r.keys, "key"), r.keys_reason);
    }
    if (r.instants_s.size() > 1)
        out.text += fmt::format("\nrecorded at {:.6g} s", fmt::join(r.instants_s, ", "));
    return out;
}

}  // namespace postlens
