#include "tracer/point_shading.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace postlens {

std::vector<ShadingNote> point_shading_notes(const Scene& scene) {
    std::vector<ShadingNote> out;
    const auto lights = std::count_if(scene.lights.begin(), scene.lights.end(),
                                      [](const Light& l) { return l.has_extent(); });
    if (lights > 0) {
        out.push_back({"penumbra", fmt::format("lights with an extent are taken as points: {} of {} "
                                               "(penumbrae need `render`)",
                                               lights, scene.lights.size())});
    }
    const auto glossy = std::count_if(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
        return (m.reflection != glm::dvec3(0) && std::isfinite(m.reflection_exponent)) ||
               (m.transmission != glm::dvec3(0) && std::isfinite(m.transmission_exponent));
    });
    if (glossy > 0) {
        out.push_back({"gloss", fmt::format("glossy or translucent materials are taken as perfect: {} of {} "
                                            "(the spread of their rays needs `render`)",
                                            glossy, scene.materials.size())});
    }
    return out;
}

}  // namespace postlens
