// What point samples shade otherwise than distributed rays do.
#pragma once

#include <string>
#include <vector>

#include "tracer/scene.h"

namespace postlens {

struct ShadingNote {
    std::string
        code;  ///< "penumbra": lights with an extent; "gloss": lobes about a mirrored or refracted ray
    std::string text;
};

/// What `render` spreads and a trace cannot; nothing where there is none.
[[nodiscard]] std::vector<ShadingNote> point_shading_notes(const Scene& scene);

}  // namespace postlens
