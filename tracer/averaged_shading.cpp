#include "tracer/averaged_shading.h"

#include <algorithm>
#include <cmath>

namespace postlens {

AveragedShading averaged_shading(const Scene& scene) {
    const auto count = [](const auto& all, const auto& is) {
        return static_cast<std::uint64_t>(std::count_if(all.begin(), all.end(), is));
    };
    return {count(scene.materials,
                  [](const Material& m) {
                      return (m.reflects() && std::isfinite(m.reflection_exponent)) ||
                             (m.transmission != glm::dvec3(0) && std::isfinite(m.transmission_exponent));
                  }),
            count(scene.lights, [](const Light& l) { return l.has_extent(); })};
}

}  // namespace postlens
