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

/// Reads all materials of the document and converts them from glTF's metallic-roughness model to Whitted's
/// model. Textures that vary the metallic value, the roughness or the transmission are replaced by their mean
/// value. `notes` gets notes to the user on what is ignored. Throws Error(invalid_input).
[[nodiscard]] GltfMaterials read_gltf_materials(GltfDocument& document, SceneNotes& notes);

}  // namespace postlens
