// Reads scenes from OBJ files with MTL (using assimp), and from PLY files.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads a .obj or .ply. Every object or group of an OBJ file becomes an object with its own id.
/// docs/mesh_scenes.md lists what is ignored (with a note to the user).
/// Throws Error(invalid_input) "FILE: ...".
[[nodiscard]] Scene read_mesh_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
