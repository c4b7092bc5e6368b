// Reads scenes in postlens's own format (docs/scene_format.md).
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace postlens {

/// Largest accepted .toml scene, in bytes. Parsed numbers need about fifty times the memory of their text.
inline constexpr std::uintmax_t largest_toml_bytes = 8'000'000;

/// Reads a .toml scene and fills in all defaults. Lengths are multiplied by `options.metres_per_unit`.
/// Throws Error(invalid_input) "FILE:LINE:COLUMN: ...".
[[nodiscard]] Scene read_toml_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
