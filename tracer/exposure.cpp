#include "tracer/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/threads.h"
#include "pictures/exposure.h"
#include "tracer/distributed/recentre.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/whitted.h"
#include "tracer/trace.h"

namespace postlens {
namespace {

constexpr int preview_px = 96;  ///< length of the preview's longer side

CameraModel preview_camera(const Camera& of, double time_s, CameraOverrides overrides) {
    const CameraModel whole(of, time_s, overrides);
    const int longer = std::max(whole.width, whole.height);
    const auto scaled = [&](int px) {
        return std::max(1, static_cast<int>(std::lround(double{preview_px} * px / longer)));
    };
    overrides.width = scaled(whole.width);
    overrides.height = scaled(whole.height);
    return {of, time_s, overrides};
}

}  // namespace

void expose(Scene& scene, double stops) {
    if (scene.exposure_stops == stops) return;
    const double gain = exposure_gain(stops - scene.exposure_stops);
    for (Light& l : scene.lights) l.intensity *= gain;
    for (Material& m : scene.materials) m.emission *= gain;
    scene.background *= gain;
    scene.ambient_light *= gain;
    scene.exposure_stops = stops;
}

double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                           const CameraOverrides& overrides) {
    const Camera& placed = find_camera(scene, camera_name);
    const Scene centred = recentred(scene, preview_camera(placed, scene.time_s, overrides).position);
    const RayScene rays(centred, scene.time_s);
    const CameraModel camera = preview_camera(find_camera(centred, placed.name), scene.time_s, overrides);
    const WhittedTracer tracer(rays, camera,
                               {.max_depth = 5, .min_contribution = 0, .refocus_matrices = false});
    const auto width = static_cast<std::size_t>(camera.width);
    std::vector<double> values(width * static_cast<std::size_t>(camera.height));
    const double gain = exposure_gain(-scene.exposure_stops);
    parallel_for(static_cast<std::size_t>(camera.height), [&](std::size_t y) {
        std::vector<glm::dvec2> centres;
        for (std::size_t x = 0; x < width; ++x)
            centres.emplace_back(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        TracedSamples samples;
        RayCounts counts;
        tracer.trace(centres, samples, counts);
        for (std::size_t x = 0; x < width; ++x) {
            glm::dvec3 sum(0);
            for (std::uint32_t k = samples.offsets[x]; k < samples.offsets[x + 1]; ++k) {
                const Record& r = samples.records[k];
                sum += glm::dvec3(r.r, r.g, r.b);
            }
            values[y * width + x] = gain * std::max({sum.x, sum.y, sum.z});
        }
    });
    return auto_exposure_of(values);
}

}  // namespace postlens
