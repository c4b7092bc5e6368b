// Scenes in glTF 2.0 [gltf2].
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Reads a .gltf or .glb: meshes, nodes, cameras, lights, materials, and animations of nodes as keyframes of
/// a motion. docs/mesh_scenes.md describes the conversion, and which contents are ignored (with a note to the
/// user). Every node with a mesh becomes an object with its own id. Nodes with the same mesh share its
/// triangles. Throws Error(invalid_input) "FILE: PLACE ...".
[[nodiscard]] Scene read_gltf_scene(const std::filesystem::path& path, const SceneReadOptions& options);

}  // namespace postlens
