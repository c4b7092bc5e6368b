// Reads the materials and textures of a glTF document.
#pragma once

#include <vector>

#include "scene/gltf/gltf_document.h"
#include "scene/gltf/gltf_meshes.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"

namespace postlens {

struct GltfMaterials {
    std::vector<Material> materials;  ///< one per material of the document
    std::vector<UvSource> uvs;        ///< for each material, the texture coordinates of its textures
};

/// Reads all materials and converts them to Whitted's model (scene/metallic_roughness.h).
/// A texture of metallic, roughness or transmission is replaced by its mean.
/// There is a note to the user for everything that is ignored. Throws Error(invalid_input).
[[nodiscard]] GltfMaterials read_gltf_materials(GltfDocument& document, SceneNotes& notes);

}  // namespace postlens
