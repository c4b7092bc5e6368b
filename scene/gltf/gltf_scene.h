// Reads scenes in glTF 2.0 [gltf2].
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads a .gltf or .glb. Every node with a mesh becomes an object with its own id.
/// Nodes with the same mesh share its triangles. docs/mesh_scenes.md lists what is ignored.
/// Throws Error(invalid_input) "FILE: PLACE ...".
[[nodiscard]] Scene read_gltf_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
