// Scenes in glTF 2.0 [gltf2].
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads a .gltf or .glb: meshes, nodes, cameras, lights, materials, and the animations of nodes as keyed
/// motion. docs/mesh_scenes.md describes the conversion and what is left out (with a note). Every node with a
/// mesh becomes an object with its own id; nodes with the same mesh share its triangles. Throws
/// Error(invalid_input) "FILE: PLACE ...".
[[nodiscard]] Scene read_gltf_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
