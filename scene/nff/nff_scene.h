// Reads scenes in the Neutral File Format [haines1987], in the variant that the Standard Procedural Databases
// use.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads v, b, l, f, c, s, p, pp and comments. Lengths are multiplied by `options.metres_per_unit`.
/// docs/scene_format.md describes the conversion, the defaults, and which contents are skipped (with a note
/// to the user). Every `s` and `c` becomes an object with its own id. Consecutive `p` and `pp` under one `f`
/// become one mesh with one id. Throws Error(invalid_input) "FILE:LINE: ...".
[[nodiscard]] Scene read_nff_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
