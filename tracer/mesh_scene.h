// Scenes from OBJ with MTL (through assimp), and from PLY.
#pragma once

#include "tracer/scene.h"

namespace postlens {

/// Reads a .obj or .ply. How it becomes a scene and what is left out (with a note) stands in
/// docs/mesh_scenes.md. Every object or group of an OBJ is an object with an id of its own. Throws
/// Error(invalid_input) "FILE: ...".
[[nodiscard]] Scene read_mesh_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
