// The materials and pictures of a glTF document.
#pragma once

#include <vector>

#include "tracer/gltf_document.h"
#include "tracer/gltf_meshes.h"
#include "tracer/scene.h"
#include "tracer/scene_notes.h"

namespace postlens {

struct GltfMaterials {
    std::vector<Material> materials;  ///< one per material of the document
    std::vector<UvSource> uvs;        ///< where the pictures of each look
};

/// Every material as Whitted's model has it (metallic_roughness.h). Pictures stand for colour and emission;
/// of those for metallic, roughness and transmission the mean counts. What is left out is noted. Throws
/// Error(invalid_input).
[[nodiscard]] GltfMaterials read_gltf_materials(GltfDocument& document, SceneNotes& notes);

}  // namespace postlens
