#include <algorithm>
#include <cmath>

#include "apps/command.h"

namespace postlens {

namespace {

// What distributed rays would spread and point samples cannot.
void warn_of_spread(const Scene& scene, CommandResult& out) {
    const auto lights = std::count_if(scene.lights.begin(), scene.lights.end(),
                                      [](const Light& l) { return l.has_extent(); });
    if (lights > 0) {
        out.warnings.push_back({"penumbra", fmt::format("lights with an extent are taken as points: {} of {} "
                                                        "(penumbrae need `render`)",
                                                        lights, scene.lights.size())});
    }
    const auto glossy = std::count_if(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
        return (m.reflection != glm::dvec3(0) && std::isfinite(m.reflection_exponent)) ||
               (m.transmission != glm::dvec3(0) && std::isfinite(m.transmission_exponent));
    });
    if (glossy > 0) {
        out.warnings.push_back(
            {"gloss", fmt::format("glossy or translucent materials are taken as perfect: {} of {} "
                                  "(the spread of their rays needs `render`)",
                                  glossy, scene.materials.size())});
    }
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
    const Scene scene = read_scene(options.scene, {.metres_per_unit = options.metres_per_unit});
    CommandResult out;
    for (const std::string& note : scene.notes) out.warnings.push_back({"scene", note});
    warn_of_spread(scene, out);
    const TraceResult r = trace_to_file(scene, options.settings, options.output);
    out.json = {{"records", r.records},
                {"bytes", r.bytes},
                {"rays", rays_json(r.rays)},
                {"overscan_px", r.overscan_px}};
    out.text = fmt::format("{}: {} records, {:.1f} MB; {} eye, {} reflected, {} refracted, {} shadow rays",
                           options.output, r.records, static_cast<double>(r.bytes) / 1e6, r.rays.eye,
                           r.rays.reflect, r.rays.refract, r.rays.shadow);
    return out;
}

}  // namespace postlens
