// Scenes in postlens' own format (docs/scene_format.md).
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace postlens {

/// Largest .toml scene that is read, bytes. Parsed numbers take about fifty times the memory of their text.
inline constexpr std::uintmax_t largest_toml_bytes = 8'000'000;

/// Reads a .toml scene and resolves all defaults; lengths are multiplied by `options.metres_per_unit`.
/// Scene::sha256 is that of the file's bytes, followed by a line "name sha256" for each file that it refers
/// to, in the file's order and with the name as written. Throws Error(invalid_input)
/// "FILE:LINE:COLUMN: ...".
[[nodiscard]] Scene read_toml_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
