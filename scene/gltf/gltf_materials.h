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
    std::vector<UvSource> uvs;        ///< per material, the texture coordinates that its textures use
};

/// All materials, converted to Whitted's model (scene/metallic_roughness.h). Textures are used for colour and
/// emission; those of metallic, roughness and transmission are replaced by their means. Everything that is
/// left out causes a note. Throws Error(invalid_input).
[[nodiscard]] GltfMaterials read_gltf_materials(GltfDocument& document, SceneNotes& notes);

}  // namespace postlens
