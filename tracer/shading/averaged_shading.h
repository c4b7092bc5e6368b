// Counts the glossy materials and the area lights of a scene. A surface that is glossy or lit by an area
// light receives light from many directions. A sample file stores the mean over several of them.
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
