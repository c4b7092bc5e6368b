#include "tracer/shading/averaged_shading.h"

#include <algorithm>

namespace postlens {

AveragedShading averaged_shading(const Scene& scene) {
    const auto count = [](const auto& all, const auto& is) {
        return static_cast<std::uint64_t>(std::count_if(all.begin(), all.end(), is));
    };
    return {count(scene.materials, [](const Material& m) { return m.has_lobe(); }),
            count(scene.lights, [](const Light& l) { return l.has_extent(); })};
}

}  // namespace postlens
