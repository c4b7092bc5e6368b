// The triangles of a glTF document.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tracer/gltf_accessor.h"
#include "tracer/scene.h"
#include "tracer/scene_notes.h"

namespace postlens {

/// Which (u, v) of its mesh a material reads, and how they are changed: KHR_texture_transform's matrix, with
/// v running downwards.
struct UvSource {
    std::size_t set = 0;  ///< TEXCOORD_set
    glm::dvec2 offset{0}, scale{1};
    double rotation = 0;  ///< radians
    [[nodiscard]] bool operator==(const UvSource&) const = default;
};

/// One primitive of a mesh.
struct GltfPart {
    std::shared_ptr<const Mesh> mesh;
    std::optional<std::size_t> material;  ///< index in the document
};

/// The primitives of mesh `index` that have triangles, in metres. Points and lines, triangles without area,
/// skins' weights and morph targets are left out with a note. `uvs`: by material of the document, where its
/// textures look. Throws Error(invalid_input).
[[nodiscard]] std::vector<GltfPart> read_gltf_mesh(const GltfDocument& document, std::size_t index,
                                                   GltfAccessors& accessors, const std::vector<UvSource>& uvs,
                                                   double metres_per_unit, SceneNotes& notes);

}  // namespace postlens
