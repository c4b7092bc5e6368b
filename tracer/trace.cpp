#include "tracer/trace.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "core/error.h"
#include "core/progress.h"
#include "core/threads.h"
#include "lens/focus_geometry.h"
#include "tracer/shape_bounds.h"

namespace postlens {
namespace {

constexpr int largest_levels = 8;

// A sphere around a box, m; finite also for infinite planes.
void bound(const Bounds& box, ObjectMotion& motion) {
    constexpr double farthest_m = 1e9;
    const glm::dvec3 low = glm::max(box.min, glm::dvec3(-farthest_m)),
                     high = glm::min(box.max, glm::dvec3(farthest_m));
    if (box.empty()) return;
    motion.centre_m = 0.5 * (low + high);
    motion.radius_m = 0.5 * glm::length(high - low);
}

// What moves, and the lights whose shadows may.
SceneMotion motion_of(const Scene& scene, const Camera& camera) {
    SceneMotion out;
    std::map<std::uint32_t, Bounds> boxes;
    for (const Object& o : scene.objects) {
        if (o.keys.empty()) continue;
        out.objects.try_emplace(o.id, ObjectMotion{.keys = o.keys});
        boxes[o.id].add(shape_bounds(o.shape, o.motion_base));
    }
    for (auto& [id, motion] : out.objects) bound(boxes[id], motion);
    out.camera = camera.keys;
    const bool shadows_move = !out.objects.empty();
    for (const Light& l : scene.lights) {
        if (l.keys.empty() && !(shadows_move && l.casts_shadows)) continue;
        const bool directional = l.kind == Light::Kind::directional;
        out.lights.push_back({directional, directional ? l.direction : l.position, l.casts_shadows, l.keys});
    }
    return out;
}

void check_whole(const char* option, int value, int low, int high) {
    if (value < low || value > high) {
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected {} to {})", option, value, low,
             high);
    }
}

void check_not_negative(const char* option, double value) {
    if (!(value >= 0) || !std::isfinite(value)) {
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected a number from 0 on)", option,
             value);
    }
}

void check(const TraceSettings& s) {
    check_whole("--subdivide", s.subdivision.levels, 0, largest_levels);
    check_whole("--overscan", s.overscan_px, 0, 16384);
    check_not_negative("--threshold", s.subdivision.threshold);
    check_tracing(s.whitted.max_depth, s.whitted.min_contribution, s.time_s);
    if (s.overscan_auto && !(s.for_f_number && s.for_focus_m)) {
        fail(ExitCode::wrong_arguments,
             "--overscan auto: needs to know the lens (expected --for-f-number and --for-focus)");
    }
}

// The widest circle of confusion, as a radius in px, among the nodes of one traced sample.
double widest_radius_px(const FocusGeometry& lens, const Record* records, std::size_t count) {
    double widest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Mat2& w = records[i].w;
        const double f = lens.inverse_focus_per_m;
        const auto a = static_cast<double>(w.xx), b = static_cast<double>(w.xy),
                   c = static_cast<double>(w.yx), d = static_cast<double>(w.yy);
        widest = std::max(widest,
                          std::sqrt((f - a) * (f - a) + b * b + c * c + (f - d) * (f - d)) / std::sqrt(2.0));
    }
    return widest * lens.aperture_radius_m * lens.gain_px;
}

// A coarse trace around the frame: overscan reaches as far as something there blurs back into the frame.
int find_overscan(const WhittedTracer& tracer, const CameraModel& camera, const TraceSettings& settings) {
    constexpr int step_px = 8;
    const int farthest = std::min(4096, std::max(camera.width, camera.height) / 2);
    const FocusGeometry lens =
        focus_geometry({camera.film_distance_mm, *settings.for_f_number}, *settings.for_focus_m,
                       Framing::keep, {camera.film_distance_mm, camera.pixel_pitch_mm});
    std::vector<std::vector<glm::dvec2>> rows;
    for (int y = -farthest; y <= camera.height + farthest; y += step_px) {
        std::vector<glm::dvec2> row;
        for (int x = -farthest; x <= camera.width + farthest; x += step_px) {
            if (x < 0 || y < 0 || x > camera.width || y > camera.height) row.emplace_back(x, y);
        }
        if (!row.empty()) rows.push_back(std::move(row));
    }
    std::vector<int> needed(rows.size(), 0);
    parallel_for(rows.size(), [&](std::size_t i) {
        TracedSamples traced;
        RayCounts counts;
        tracer.trace(rows[i], traced, counts);
        for (std::size_t k = 0; k < rows[i].size(); ++k) {
            const glm::dvec2 p = rows[i][k];
            const double outside = std::max({-p.x, p.x - camera.width, -p.y, p.y - camera.height});
            const double radius = widest_radius_px(lens, traced.records.data() + traced.offsets[k],
                                                   traced.offsets[k + 1] - traced.offsets[k]);
            if (radius + step_px > outside)
                needed[i] = std::max(needed[i], static_cast<int>(std::ceil(outside)) + step_px);
        }
    });
    return rows.empty() ? 0 : std::min(farthest, *std::max_element(needed.begin(), needed.end()));
}

}  // namespace

void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s) {
    check_whole("--max-depth", max_depth, 1, NodePath::max_bounces + 1);
    check_not_negative("--min-contribution", min_contribution);
    if (time_s && !std::isfinite(*time_s)) {
        fail(ExitCode::wrong_arguments, "--time: out of range (got {}; expected seconds)", *time_s);
    }
}

const Camera& find_camera(const Scene& scene, const std::string& name) {
    if (scene.cameras.empty()) fail(ExitCode::invalid_input, "{}: the scene has no camera", scene.name);
    if (name.empty()) return scene.cameras.front();
    std::string known;
    for (const Camera& c : scene.cameras) {
        if (c.name == name) return c;
        known += (known.empty() ? "" : ", ") + c.name;
    }
    fail(ExitCode::wrong_arguments, "--camera: no such camera (got {}; expected one of: {})", name, known);
}

SampleHeader sample_header(const Scene& scene, const TraceSettings& settings, const CameraModel& camera,
                           double time_s, int overscan_px) {
    const Camera& of = find_camera(scene, settings.camera_name);
    SampleHeader h;
    h.width = camera.width;
    h.height = camera.height;
    h.overscan_px = overscan_px;
    h.projection = camera.projection == Camera::Projection::perspective ? Projection::perspective
                                                                        : Projection::orthographic;
    h.film_distance_mm = camera.film_distance_mm;
    h.pixel_pitch_mm = camera.pixel_pitch_mm;
    h.focal_length_mm = camera.film_distance_mm;
    h.f_number = of.f_number;
    h.focus_m = of.focus_m;
    h.exposure_s = of.exposure_s;
    h.world_from_camera = camera.world_from_camera;
    h.time_s = time_s;
    h.subdivide_levels = settings.subdivision.levels;
    h.subdivide_threshold = settings.subdivision.threshold;
    h.max_depth = settings.whitted.max_depth;
    h.min_contribution = settings.whitted.min_contribution;
    h.scene_name = scene.name;
    h.scene_sha256 = scene.sha256;
    for (const Object& o : scene.objects) h.object_names.emplace(o.id, o.name);
    h.motion = motion_of(scene, of);
    for (const auto& [id, motion] : h.motion.objects) h.moving_ids.push_back(id);
    h.lights_move =
        std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return !l.keys.empty(); });
    h.sufficient.smallest_f_number = settings.for_f_number;
    h.sufficient.nearest_focus_m = h.sufficient.farthest_focus_m = settings.for_focus_m;
    return h;
}

TraceResult trace_to_file(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path) {
    check(settings);
    const Camera& of = find_camera(scene, settings.camera_name);
    const double time_s = settings.time_s.value_or(scene.time_s);
    const CameraModel camera(of, time_s, settings.camera);
    if (settings.overscan_auto && camera.projection == Camera::Projection::orthographic) {
        fail(ExitCode::wrong_arguments,
             "--overscan auto: an orthographic camera has no lens to be wide enough for (expected a number "
             "of px)");
    }
    const RayScene rays(scene, time_s);
    const WhittedTracer tracer(rays, camera, settings.whitted);

    TraceResult result;
    result.overscan_px =
        settings.overscan_auto ? find_overscan(tracer, camera, settings) : settings.overscan_px;
    SampleHeader header = sample_header(scene, settings, camera, time_s, result.overscan_px);
    header.has_w = tracer.has_deeper_nodes();
    SampleFileWriter writer(path, header, settings.compression);

    const int o = result.overscan_px;
    const SampledWindow window{-o, camera.width + o, -o, camera.height + o};
    Progress progress("trace", static_cast<std::uint64_t>(camera.height + 2 * o), settings.quiet);
    result.rays = sample_corners(tracer, window, settings.subdivision, [&](const RecordBand& band) {
        throw_if_interrupted();
        writer.write(band);
        result.records += band.records.size();
        progress.advance(static_cast<std::uint64_t>(band.height()));
    });
    result.bytes = writer.finish();
    return result;
}

}  // namespace postlens
