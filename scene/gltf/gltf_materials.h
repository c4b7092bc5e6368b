// The materials and textures of a glTF document.
#pragma once

#include <vector>

#include "scene/gltf/gltf_document.h"
#include "scene/gltf/gltf_meshes.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"

namespace postlens {

struct GltfMaterials {
    std::vector<Material> materials;  ///< one per material of the document
    std::vector<UvSource> uvs;        ///< for each material, the texture coordinates that its textures use
};

/// Reads all materials and converts them to Whitted's model (scene/metallic_roughness.h). Textures of colour
/// and emission are read. Textures of metallic, roughness and transmission are replaced by their means.
/// Everything that is ignored causes a note to the user. Throws Error(invalid_input).
[[nodiscard]] GltfMaterials read_gltf_materials(GltfDocument& document, SceneNotes& notes);

}  // namespace postlens
