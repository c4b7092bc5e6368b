// Scenes in the Neutral File Format [haines1987], as the Standard Procedural Databases write it.
#pragma once

#include "tracer/scene.h"

namespace postlens {

/// Reads v, b, l, f, c, s, p, pp and comments. Lengths are multiplied by `options.metres_per_unit`. How the
/// format's numbers become a scene, what is made up and what is skipped (each with a note) stands in
/// docs/scene_format.md. Every `s` and `c` is an object with an id of its own; a run of `p` and `pp` under
/// one `f` is one mesh with one id. Throws Error(invalid_input) "FILE:LINE: ...".
[[nodiscard]] Scene read_nff_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
