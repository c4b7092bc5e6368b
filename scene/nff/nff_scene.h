// Reads scenes in the Neutral File Format [haines1987], as used by the Standard Procedural Databases.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads the NFF entities v, b, l, f, c, s, p, pp and comments. `options.metres_per_unit` scales lengths.
/// Every sphere `s` and cone `c` becomes an object. Successive polygons (`p`, `pp`) with the same fill `f`
/// become one mesh. Each object has its own id. docs/scene_format.md lists defaults and what is skipped.
/// Throws Error(invalid_input) "FILE:LINE: ...".
[[nodiscard]] Scene read_nff_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
