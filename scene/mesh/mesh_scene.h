// Reads scenes from OBJ with MTL (by assimp), and from PLY.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads a .obj or .ply. docs/mesh_scenes.md describes the conversion, and which contents are ignored (with a
/// note to the user). Every object or group of an OBJ becomes an object with its own id. Throws
/// Error(invalid_input) "FILE: ...".
[[nodiscard]] Scene read_mesh_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
