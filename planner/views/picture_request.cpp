#include "planner/views/picture_request.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "focus/light_field/lens_views.h"
#include "pictures/aperture_file.h"
#include "pictures/crop.h"

namespace postlens {
namespace {

CameraOverrides overrides_of(const SampleHeader& h) {
    return {h.width, h.height, h.film_distance_mm, h.pixel_pitch_mm * h.width};
}

/// Returns the name of the scene's camera through which the file was traced.
std::string camera_of(const SampleHeader& h, const Scene& scene) {
    for (const Camera& c : scene.cameras) {
        if ((c.projection == Camera::Projection::perspective) != (h.projection == Projection::perspective))
            continue;
        const CameraModel model(c, h.time_s, overrides_of(h));
        double difference = 0, size = 1;
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                difference =
                    std::max(difference, std::abs(model.world_from_camera[i][j] - h.world_from_camera[i][j]));
                size = std::max(size, std::abs(h.world_from_camera[i][j]));
            }
        }
        if (difference <= 1e-9 * size) return c.name;
    }
    fail(ExitCode::invalid_input,
         "{}: has no camera that stands where the sample file's does (expected the scene that it was traced "
         "from)",
         scene.name);
}

}  // namespace

std::string checked_camera(const SampleHeader& h, const Scene& scene) {
    if (scene.sha256 != h.scene_sha256) {
        fail(ExitCode::invalid_input,
             "{}: is not the scene that the sample file was traced from (got SHA-256 {:.12}...; expected "
             "{:.12}...)",
             scene.name, scene.sha256, h.scene_sha256);
    }
    return camera_of(h, scene);
}

void check_request(const SampleFileReader& file, const HybridSettings& settings, const std::string& method) {
    const SampleHeader& h = file.header();
    // The image is made from views, each of which shows the scene from one point of a lens. An orthographic
    // camera has no lens. Therefore, files that were traced with such a camera are refused.
    if (h.projection == Projection::orthographic) {
        fail(ExitCode::wrong_arguments,
             "{}: rays and views need a perspective camera (got an orthographic sample file)",
             settings.scene != nullptr ? "--scene" : method);
    }
    if (settings.focus.framing != Framing::keep) {
        fail(ExitCode::wrong_arguments,
             "--framing, --breathing: not with {}, as rays and views have the framing of the trace (expected "
             "--framing keep)",
             method);
    }
    check_has_points(settings.focus.impulse);
    check_crop(settings.focus.crop, h.width, h.height);
    if (settings.scene == nullptr || settings.scene->exposure_stops == file.exposure_stops()) return;
    fail(ExitCode::wrong_arguments,
         "{}: exposed otherwise than the sample file (got {} stops; expected {} stops)", settings.scene->name,
         settings.scene->exposure_stops, file.exposure_stops());
}

FieldFocusSettings field_settings(const SampleHeader& h, const HybridSettings& s) {
    FieldFocusSettings out{.geometry = focus_geometry(s.focus.lens, s.focus.focus_distance_m, Framing::keep,
                                                      {h.film_distance_mm, h.pixel_pitch_mm}),
                           .aperture = read_aperture(s.focus.impulse),
                           .window = {0, h.width, 0, h.height},
                           .views = s.focus.views,
                           .crop = s.focus.crop};
    if (s.motion != nullptr && s.shutter)
        out.shutter = {s.motion, s.shutter->open_s, s.shutter->close_s, s.curve};
    return out;
}

RenderSettings ray_settings(const SampleHeader& h, const HybridSettings& s, const Aperture& aperture) {
    RenderSettings r;
    r.camera = overrides_of(h);
    r.camera_name = checked_camera(h, *s.scene);
    r.time_s = h.time_s;
    r.focal_length_mm = s.focus.lens.focal_length_mm;
    r.f_number = s.focus.lens.f_number;
    r.focus_m = s.focus.focus_distance_m;
    r.aperture = std::make_shared<Aperture>(aperture);
    r.shutter = s.shutter;
    r.curve = s.curve;
    r.tracing = {h.max_depth, h.min_contribution};
    return r;
}

}  // namespace postlens
