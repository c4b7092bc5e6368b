// Counts the materials and lights of a scene whose light comes from many directions: glossy materials and
// area lights. For a surface with such a material or light, a sample file stores the mean over several random
// directions. The command `trace` reports these numbers.
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
