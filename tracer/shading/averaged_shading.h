// Counts a scene's glossy materials and area lights. A sample file stores the light of each as a mean over
// several rays.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace postlens {

struct AveragedShading {
    std::uint64_t materials =
        0;  ///< materials that reflect or refract into a lobe (tracer/shading_trees/lobe_means.h)
    std::uint64_t lights = 0;  ///< lights with an extent (light_means.h)
    [[nodiscard]] bool any() const { return materials > 0 || lights > 0; }
};

[[nodiscard]] AveragedShading averaged_shading(const Scene& scene);

}  // namespace postlens
