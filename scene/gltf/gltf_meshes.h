// Reads the triangles of a glTF document.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "scene/gltf/gltf_accessor.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"

namespace postlens {

/// Texture coordinates of a material: a TEXCOORD set of the mesh, transformed by KHR_texture_transform. v
/// points down.
struct UvSource {
    std::size_t set = 0;  ///< TEXCOORD_set
    glm::dvec2 offset{0}, scale{1};
    double rotation = 0;  ///< radians
    [[nodiscard]] bool operator==(const UvSource&) const = default;
};

/// One primitive of a mesh.
struct GltfPart {
    std::shared_ptr<const Mesh> mesh;
    std::optional<std::size_t> material;  ///< index in the document; empty for the default material
};

/// Reads the mesh `index` of the document and returns its primitives (parts with one material) that have
/// triangles. Lengths are multiplied by `metres_per_unit`, so they are in metres. `uvs` tells for each
/// material which texture coordinates it uses. `notes` gets notes to the user on what is ignored. Throws
/// Error(invalid_input).
[[nodiscard]] std::vector<GltfPart> read_gltf_mesh(const GltfDocument& document, std::size_t index,
                                                   GltfAccessors& accessors, const std::vector<UvSource>& uvs,
                                                   double metres_per_unit, SceneNotes& notes);

}  // namespace postlens
