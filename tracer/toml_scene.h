// Scenes in postlens' own format, described in docs/scene_format.md.
#pragma once

#include <cstdint>

#include "tracer/scene.h"

namespace postlens {

/// A .toml scene larger than this is refused before it is read: parsed numbers take about fifty times their
/// text.
inline constexpr std::uintmax_t largest_toml_bytes = 8'000'000;

/// Reads a .toml scene with all its defaults resolved; lengths are multiplied by `options.metres_per_unit`.
/// Scene::sha256 is that of the file; where it refers to others, of the file's bytes followed by, for each of
/// them in the file's order, a line "name sha256" with the name as written. Throws Error(invalid_input)
/// "FILE:LINE:COLUMN: ...".
[[nodiscard]] Scene read_toml_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
