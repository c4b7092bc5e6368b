// Scenes in postlens' own format (docs/scene_format.md).
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace postlens {

/// Largest .toml scene that is read, bytes. Parsed numbers need about fifty times the memory of their text.
inline constexpr std::uintmax_t largest_toml_bytes = 8'000'000;

/// Reads a .toml scene and resolves all defaults. Lengths are multiplied by `options.metres_per_unit`.
/// Scene::sha256 covers the bytes of the file, followed by a line "name sha256" for each file to which it
/// refers. The order and the names of these lines are those of the scene file. Throws Error(invalid_input)
/// "FILE:LINE:COLUMN: ...".
[[nodiscard]] Scene read_toml_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
