#include "planner/retrace.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "tracer/eye_rays.h"

namespace postlens {
namespace {

CameraOverrides overrides_of(const SampleHeader& h) {
    return {h.width, h.height, h.film_distance_mm, h.pixel_pitch_mm * h.width};
}

/// The scene's camera that the file was traced through.
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

void check_exposed_alike(const Scene& scene, const SampleFileReader& file) {
    if (scene.exposure_stops == file.exposure_stops()) return;
    fail(ExitCode::wrong_arguments,
         "{}: exposed otherwise than the sample file (got {} stops; expected {} stops)", scene.name,
         scene.exposure_stops, file.exposure_stops());
}

RenderSettings retrace_settings(const SampleHeader& h, const HybridSettings& s, const std::string& camera,
                                const Aperture& aperture) {
    RenderSettings r;
    r.camera = overrides_of(h);
    r.camera_name = camera;
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

void limit_retraced(double most_retraced, std::vector<std::uint32_t>& pixels, HybridResult& out) {
    if (out.wanted_share <= most_retraced) return;
    const auto most = static_cast<std::size_t>(most_retraced * static_cast<double>(out.what.size()));
    out.focus.warnings.push_back(
        {"retraced", out.wanted_share - most_retraced,
         fmt::format(
             "the records do not suffice for {} % of the pixels; {} %, the worst of them, are traced "
             "again (expected a trace for this lens, or render where mirrors and glass show too much)",
             rough(100 * out.wanted_share), rough(100 * most_retraced))});
    pixels.resize(std::min(pixels.size(), most));
}

void retrace(const Scene& scene, const RenderSettings& render, std::vector<std::uint32_t> pixels,
             HybridResult& out) {
    if (pixels.empty()) return;
    std::sort(pixels.begin(), pixels.end());  // neighbours together
    const RenderedPixels traced = render_pixels(scene, render, pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        std::copy(traced.rgb[i].begin(), traced.rgb[i].end(),
                  out.focus.image.rgb.begin() + 3 * std::ptrdiff_t{pixels[i]});
        out.what[pixels[i]] = 2;
    }
    out.rays += traced.rays;
    out.retraced_share += static_cast<double>(pixels.size()) / static_cast<double>(out.what.size());
}

}  // namespace postlens
