#include "tracer/trace.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/memory.h"
#include "core/progress.h"
#include "lens/focus_geometry.h"
#include "pictures/exposure.h"
#include "tracer/distributed/recentre.h"
#include "tracer/recording/expected_size.h"
#include "tracer/recording/key_instants.h"
#include "tracer/recording/overscan.h"
#include "tracer/recording/recorded_motion.h"
#include "tracer/recording/small_things.h"
#include "tracer/recording/trace_share.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/shading_trees/lens_reach.h"

namespace postlens {
namespace {

constexpr int largest_levels = 8;

// Width, px, of a border around the traced window. From some lens points, a surface is visible past the edge
// of a nearer one. This surface is to be recorded if it lies inside the window, but the edge may lie outside.
// So edges are also searched for in the border.
constexpr int beyond_records_px = 32;

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
    if (s.overscan_auto && !(s.for_f_number && s.for_focus_m) && !s.for_shutter) {
        fail(ExitCode::wrong_arguments,
             "--overscan auto: needs to know the lens or the shutter (expected --for-f-number and "
             "--for-focus, "
             "or --for-shutter)");
    }
    if (s.for_shutter) check_shutter("--for-shutter", *s.for_shutter);
    if (s.hidden_layers) check_whole("--hidden-layers", *s.hidden_layers, 0, HiddenLayers::most);
    if (s.for_f_number && (!(*s.for_f_number > 0) || !std::isfinite(*s.for_f_number))) {
        fail(ExitCode::wrong_arguments, "--for-f-number: out of range (got {}; expected a number above 0)",
             *s.for_f_number);
    }
    if (s.for_focus_m && !(*s.for_focus_m > 0)) {
        fail(ExitCode::wrong_arguments, "--for-focus: out of range (got {}; expected more than 0, or inf)",
             *s.for_focus_m);
    }
    if (s.hidden_auto && !s.for_shutter && !s.for_f_number) {
        fail(ExitCode::wrong_arguments,
             "--hidden-layers auto: needs to know the lens or the shutter (expected --for-f-number or "
             "--for-shutter)");
    }
    if (s.keys) check_whole("--keys", *s.keys, 1, static_cast<int>(SampleHeader::most_keys));
    if (s.keys != 1 && !s.for_shutter) {
        fail(ExitCode::wrong_arguments, "--keys: needs to know the shutter (expected --for-shutter)");
    }
}

// An instant at which the scene is recorded. Holds the scene and the camera, and which hidden surfaces are
// recorded.
class Instant {
  public:
    Instant(const Scene& scene, const TraceSettings& settings, const Camera& of, const SceneMotion& motion,
            double time_s, const std::vector<double>& recorded_s)
        : camera_(of, time_s, settings.camera), rays_(scene, time_s) {
        if (settings.for_shutter) {
            const TimeSpan& shutter = *settings.for_shutter;
            motion_.emplace(motion, of, settings.camera, time_s,
                            looked_at_instants(motion, shutter.open_s, shutter.close_s, recorded_s));
        }
        tracer_.emplace(rays_, camera_, settings.whitted, hidden_layers(settings));
    }
    void look_through_lens(const TraceSettings& settings, const SampledWindow& w) {
        if (!settings.for_f_number || settings.hidden_layers ||
            camera_.projection == Camera::Projection::orthographic)
            return;
        constexpr int more = beyond_records_px;
        lens_.emplace(rays_, camera_, settings.whitted.bend_radius_m, settings.whitted.max_depth,
                      settings.narrow_strip_px, w.x_begin - more, w.x_end + more + 1, w.y_begin - more,
                      w.y_end + more + 1);
        tracer_.emplace(rays_, camera_, settings.whitted, hidden_layers(settings));
    }
    Instant(const Instant&) = delete;
    Instant& operator=(const Instant&) = delete;
    Instant(Instant&&) = delete;
    Instant& operator=(Instant&&) = delete;
    ~Instant() = default;

    [[nodiscard]] const WhittedTracer& tracer() const { return *tracer_; }
    [[nodiscard]] const CameraModel& camera() const { return camera_; }
    /// Predicts how surface points move on the raster, from the instant of this tracer to other instants of
    /// the shutter interval. Null if there is no shutter interval.
    [[nodiscard]] const FilmMotion* motion() const { return motion_ ? &*motion_ : nullptr; }
    [[nodiscard]] bool has_hidden_layers() const { return hidden_; }

  private:
    HiddenLayers hidden_layers(const TraceSettings& settings) {
        HiddenLayers out;
        out.parts = settings.whitted.parts;
        if (settings.hidden_layers) {
            out.count = *settings.hidden_layers;
        } else {
            if (motion_ && motion_->anything_moves()) out.motion = &*motion_;
            out.same_place_px = settings.narrow_strip_px;
            if (lens_) out.lens = &*lens_;
            if (!out.all()) out.count = HiddenLayers::most;
        }
        hidden_ = out.count > 0;
        return out;
    }

    CameraModel camera_;
    RayScene rays_;
    std::optional<FilmMotion> motion_;
    std::optional<LensReach> lens_;
    std::optional<WhittedTracer> tracer_;
    bool hidden_ = false;
};

// Removes the scene's exposure from the traced radiance by division, because sample files store radiance
// without exposure.
class Radiance {
  public:
    explicit Radiance(double exposure_stops) : gain_(exposure_gain(-exposure_stops)) {}
    const RecordBand& of(const RecordBand& band) {
        if (gain_ == 1) return band;
        band_ = band;
        for (Record& r : band_.records) {
            for (float* v : {&r.r, &r.g, &r.b}) *v = static_cast<float>(static_cast<double>(*v) * gain_);
        }
        return band_;
    }

  private:
    double gain_;
    RecordBand band_;
};

// Returns the radius, m, of the widest lens for which images will be made from the sample file.
// The lens's f-number is the setting `for_f_number`, else that of the scene's camera, else 1.4.
double lens_radius_m(const Scene& scene, const TraceSettings& settings) {
    const Camera& of = find_camera(scene, settings.camera_name);
    const CameraModel camera(of, scene.time_s, settings.camera);
    constexpr double usual_f_number = 1.4;
    const double f_number = settings.for_f_number.value_or(of.f_number.value_or(usual_f_number));
    return camera.film_distance_mm / f_number / 2 * 1e-3;
}

// Returns the overscan, i.e. the width, px, of a border around the frame that must be traced at one recorded
// instant. The blur of the lens and motion during the shutter interval may bring light from this border into
// the frame. `motion` predicts the positions of surfaces at other instants. It may be null.
int overscan_for(const TraceSettings& s, const Instant& instant, const FilmMotion* motion) {
    const CameraModel& camera = instant.camera();
    std::optional<FocusGeometry> lens;
    if (s.for_f_number && s.for_focus_m) {
        if (camera.projection == Camera::Projection::orthographic) {
            fail(ExitCode::wrong_arguments,
                 "--overscan auto: an orthographic camera has no lens to be wide enough for (expected a "
                 "number "
                 "of px)");
        }
        lens = focus_geometry({camera.film_distance_mm, *s.for_f_number}, *s.for_focus_m, Framing::keep,
                              {camera.film_distance_mm, camera.pixel_pitch_mm});
    }
    return find_overscan(instant.tracer(), camera, lens, motion);
}

std::vector<double> instants_near(const SceneMotion& motion, double at_s,
                                  const std::vector<double>& recorded_s) {
    double before_s = at_s, after_s = at_s;
    for (const double t : recorded_s) {
        if (t < at_s) before_s = before_s == at_s ? t : std::max(before_s, t);
        if (t > at_s) after_s = after_s == at_s ? t : std::min(after_s, t);
    }
    return looked_at_instants(motion, before_s, after_s, std::vector<double>{at_s});
}

// Returns a lower bound of the memory for a trace. It counts only buffers that grow with the raster.
std::uint64_t least_memory_bytes(const CameraModel& camera, int overscan_px, const TraceSettings& s) {
    constexpr std::uint64_t picture_bytes_per_px = 3 * sizeof(float);
    constexpr std::uint64_t rows_of_records = 32;
    // Memory, bytes per pixel, for LensReach. This object decides which hidden surfaces the lens may see past
    // the edges of nearer ones. It stores the inverse depth of each pixel, a float. It also stores the least
    // and the greatest of these values, two floats, for squares of 1, 2 x 2, 4 x 4, ... pixels. There are 4/3
    // squares per pixel.
    constexpr std::uint64_t reach_bytes_per_px = sizeof(float) + 2 * sizeof(float) * 4 / 3;
    const auto width = static_cast<std::uint64_t>(camera.width),
               height = static_cast<std::uint64_t>(camera.height);
    const auto wide = width + 2 * static_cast<std::uint64_t>(overscan_px),
               high = height + 2 * static_cast<std::uint64_t>(overscan_px);
    const bool looks_through_lens = s.for_f_number && !s.hidden_layers;
    return width * height * picture_bytes_per_px + wide * std::min(high, rows_of_records) * sizeof(Record) +
           (looks_through_lens ? wide * high * reach_bytes_per_px : 0);
}

void require_trace_memory(const CameraModel& camera, int overscan_px, const TraceSettings& s,
                          const std::filesystem::path& path) {
    require_memory(least_memory_bytes(camera, overscan_px, s),
                   fmt::format("{}: a trace of {}x{} px", path.string(), camera.width + 2 * overscan_px,
                               camera.height + 2 * overscan_px));
}

bool has_meshes(const Scene& scene) {
    return std::any_of(scene.objects.begin(), scene.objects.end(), [](const Object& o) {
        return std::holds_alternative<std::shared_ptr<const Mesh>>(o.shape);
    });
}

}  // namespace

void require_trace_memory(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path) {
    const CameraModel camera(find_camera(scene, settings.camera_name), scene.time_s, settings.camera);
    require_trace_memory(camera, settings.overscan_auto ? 0 : settings.overscan_px, settings, path);
}

void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s) {
    check_whole("--max-depth", max_depth, 1, NodePath::max_bounces + 1);
    check_not_negative("--min-contribution", min_contribution);
    if (time_s && !std::isfinite(*time_s)) {
        fail(ExitCode::wrong_arguments, "--time: out of range (got {}; expected seconds)", *time_s);
    }
}

void check_shutter(const char* option, const TimeSpan& shutter) {
    if (!std::isfinite(shutter.open_s) || !std::isfinite(shutter.close_s)) {
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}:{}; expected seconds)", option,
             shutter.open_s, shutter.close_s);
    }
    if (shutter.close_s < shutter.open_s) {
        fail(ExitCode::wrong_arguments, "{}: closes before it opens (got {}:{}; expected OPEN <= CLOSE)",
             option, shutter.open_s, shutter.close_s);
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
    h.exposure_stops = scene.exposure_stops;
    h.auto_exposure_stops = settings.auto_exposure_stops;
    h.lumens_per_watt = scene.lumens_per_watt;
    h.metres_per_unit = scene.metres_per_unit;
    h.scene_name = scene.name;
    h.scene_sha256 = scene.sha256;
    h.made_by = settings.made_by;
    for (const Object& o : scene.objects) h.object_names.emplace(o.id, o.name);
    h.motion = recorded_motion(scene, of);
    for (const auto& [id, motion] : h.motion.objects) h.moving_ids.push_back(id);
    h.lights_move =
        std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return !l.keys.empty(); });
    h.sufficient.smallest_f_number = settings.for_f_number;
    h.sufficient.nearest_focus_m = h.sufficient.farthest_focus_m = settings.for_focus_m;
    if (settings.for_shutter) {
        h.sufficient.shutter_open_s = settings.for_shutter->open_s;
        h.sufficient.shutter_close_s = settings.for_shutter->close_s;
    }
    return h;
}

TraceResult trace_to_file(const Scene& placed, const TraceSettings& asked,
                          const std::filesystem::path& path) {
    check(asked);
    TraceSettings settings = asked;
    const double time_s = settings.time_s.value_or(placed.time_s);
    // The file's header describes the camera as it is placed in the scene. The traced copy of the scene is
    // translated so that the camera is at the origin, because float coordinates are less accurate far from
    // it.
    const Camera& placed_camera = find_camera(placed, settings.camera_name);
    const CameraModel camera(placed_camera, time_s, settings.camera);
    const Scene scene = recentred(placed, camera.position);
    settings.whitted.lens_radius_m = lens_radius_m(scene, asked);
    const ObjectParts parts(scene);
    if (parts.any()) settings.whitted.parts = &parts;
    if (asked.for_f_number) settings.whitted.bend_radius_m = settings.whitted.lens_radius_m;
    if (asked.for_f_number && asked.subdivide_for_lens) {
        settings.subdivision.colour_levels = asked.subdivision.levels;
        settings.subdivision.levels = std::max(asked.subdivision.levels, TraceSettings::lens_levels);
    }
    const Camera& of = find_camera(scene, placed_camera.name);
    TraceResult result;
    result.keys = settings.keys.value_or(1);
    if (!settings.keys) {
        const KeyCount wanted =
            automatic_keys(scene, of, settings.camera, time_s, *settings.for_shutter,
                           {settings.degrees_per_key,
                            settings.light_db,
                            {settings.whitted.max_depth, settings.whitted.min_contribution}});
        result.keys = wanted.keys;
        result.keys_sweep_degrees = wanted.sweep_degrees;
        result.keys_reason = wanted.reason;
    }
    std::vector<double> keys_s;
    if (settings.for_shutter) keys_s = key_instants(result.keys, *settings.for_shutter, time_s);
    result.instants_s = {time_s};
    result.instants_s.insert(result.instants_s.end(), keys_s.begin(), keys_s.end());

    const SceneMotion motion = recorded_motion(scene, of);
    std::unique_ptr<Instant> instant;
    const auto go_to = [&](double at_s) {
        instant.reset();  // frees the memory of an instant before the next one is built
        instant = std::make_unique<Instant>(scene, settings, of, motion, at_s, result.instants_s);
    };
    result.overscan_px = settings.overscan_auto ? 0 : settings.overscan_px;
    // Enlarges the overscan, the traced border around the frame, for each further recorded instant. The image
    // at an instant between two recorded ones is made from the records of both. So the records of each
    // instant must contain what motion brings into the frame until the next recorded instant, or since the
    // previous one.
    for (std::size_t i = 1; settings.overscan_auto && i < result.instants_s.size(); ++i) {
        const double at_s = result.instants_s[i];
        const FilmMotion near(motion, of, settings.camera, at_s,
                              instants_near(motion, at_s, result.instants_s));
        go_to(at_s);
        result.overscan_px = std::max(result.overscan_px, overscan_for(settings, *instant, &near));
    }
    go_to(time_s);
    // Enlarges the overscan, the traced border around the frame, for the instant `time_s` of the frame. Some
    // methods make the whole image from the records of this one instant. So these records must contain
    // everything that motion brings into the frame at any time of the exposure, and not only until the next
    // recorded instant.
    if (settings.overscan_auto)
        result.overscan_px =
            std::max(result.overscan_px, overscan_for(settings, *instant, instant->motion()));
    const int width = camera.width, height = camera.height, o = result.overscan_px;
    require_trace_memory(camera, o, settings, path);
    const SampledWindow window{-o, width + o, -o, height + o};
    // Finds the narrow objects at every recorded instant, and how often pixels must be divided so that eye
    // rays hit them. The limit of this division, `subdivision.levels`, is the same for all recorded instants,
    // so it must suffice for each of them.
    std::vector<SmallThings> small_things(result.instants_s.size());
    settings.subdivision.edge_levels = settings.subdivision.levels;
    settings.subdivision.colour_levels =
        std::min(settings.subdivision.colour_levels, settings.subdivision.levels);
    for (std::size_t i = 0; settings.seek_small_things && i < small_things.size(); ++i) {
        const CameraModel at(of, result.instants_s[i], settings.camera);
        SmallThings things(scene, parts, at, result.instants_s[i], window.x_begin, window.x_end + 1,
                           window.y_begin, window.y_end + 1);
        const bool sought = asked.subdivision.levels > 0;
        result.too_narrow_objects =
            std::max(result.too_narrow_objects, things.lost() + (sought ? 0 : things.objects()));
        if (sought) settings.subdivision.levels = std::max(settings.subdivision.levels, things.levels());
        small_things[i] = std::move(things);
    }
    instant->look_through_lens(settings, window);
    SampleHeader header = sample_header(placed, settings, camera, time_s, o);
    header.has_w = instant->tracer().has_deeper_nodes();
    header.has_layers = instant->has_hidden_layers();
    header.has_bend = instant->tracer().measures_bends();
    header.has_marks = instant->tracer().has_textures() || instant->tracer().has_parts() || has_meshes(scene);
    header.key_times_s = keys_s;
    SampleFileWriter writer(path, header, settings.compression);
    const auto find_outlines = [&](std::size_t i) {
        if (settings.seek_small_things)
            small_things[i].find_outlines(scene, parts, instant->camera(), result.instants_s[i]);
    };
    find_outlines(0);
    if (settings.on_expected_bytes) {
        settings.on_expected_bytes(expected_file_bytes(instant->tracer(), window, settings.subdivision,
                                                       small_things[0], header, settings.compression,
                                                       result.instants_s.size()));
    }

    Progress progress("trace", static_cast<std::uint64_t>(height + 2 * o) * result.instants_s.size());
    Radiance radiance(scene.exposure_stops);
    for (std::size_t i = 0; i < result.instants_s.size(); ++i) {
        if (i > 0) {
            go_to(result.instants_s[i]);
            instant->look_through_lens(settings, window);
            find_outlines(i);
            writer.next_instant();
        }
        const auto take = [&](const RecordBand& band) {
            throw_if_interrupted();
            writer.write(radiance.of(band));
            result.records += band.records.size();
            progress.advance(static_cast<std::uint64_t>(band.height()));
        };
        const WhittedTracer& tracer = instant->tracer();
        result.rays +=
            settings.share
                ? sample_share(*settings.share, tracer, window, settings.subdivision, take, small_things[i])
                : sample_corners(tracer, window, settings.subdivision, take, small_things[i]);
        small_things[i] = {};
    }
    result.bytes = writer.finish();
    return result;
}

}  // namespace postlens
