// What of a scene's shading a trace averages into the records of the surfaces.
#pragma once

#include <cstdint>

#include "tracer/scene.h"

namespace postlens {

struct AveragedShading {
    std::uint64_t materials = 0;  ///< whose mirrored or refracted rays spread (lobe_means.h)
    std::uint64_t lights = 0;     ///< with an extent (light_means.h)
    [[nodiscard]] bool any() const { return materials > 0 || lights > 0; }
};

[[nodiscard]] AveragedShading averaged_shading(const Scene& scene);

}  // namespace postlens
