// Divides objects with one id into parts: the shapes of a compound object, or the connected parts of a mesh,
// such as leaves. There may be gaps between parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace postlens {

/// An edge of a mesh, with the triangles on both sides.
struct MeshEdge {
    static constexpr std::uint32_t none = 0xFFFFFFFFU;
    std::uint32_t low_end = 0, high_end = 0;  ///< indices of the positions of both ends
    std::uint32_t triangle = 0, other = none;
    friend bool operator==(const MeshEdge&, const MeshEdge&) = default;
};

/// Returns the edges of the mesh. Vertices with equal positions count as one, the one with the lowest index.
/// If an edge belongs to only one triangle, `other` is `none`. If it belongs to more than two, it is listed
/// once for each pair of consecutive triangles.
[[nodiscard]] std::vector<MeshEdge> edges_of(const Mesh& mesh);

/// Returns the part to which each triangle belongs, or an empty list if the mesh has a single part.
/// A part is a set of triangles that are connected by edges, `edges_of(mesh)`.
/// Parts are numbered from 0 in the order of their first triangles.
[[nodiscard]] std::vector<std::uint32_t> parts_of(const Mesh& mesh, const std::vector<MeshEdge>& edges);

/// The connected parts of all objects of a scene, each with an index that is unique in the scene.
class ObjectParts {
  public:
    explicit ObjectParts(const Scene& scene);
    /// Returns true if any object has several parts.
    [[nodiscard]] bool any() const { return any_; }
    /// Returns the index, unique in the scene, of the connected part of a mesh that contains a triangle.
    /// `object` is an index into Scene::objects. For other shapes, `triangle` is ignored.
    [[nodiscard]] std::uint32_t part(std::size_t object, std::size_t triangle) const {
        const std::vector<std::uint32_t>& parts = of_mesh(object);
        return first_[object] + (parts.empty() ? 0 : parts[triangle]);
    }
    /// Returns, for each triangle of an object's mesh, the index of its connected part. Empty if there is
    /// only one part.
    [[nodiscard]] const std::vector<std::uint32_t>& of_mesh(std::size_t object) const {
        return meshes_[mesh_[object]].parts;
    }
    /// Returns the edges of an object's mesh (edges_of). Empty if the object is not a mesh.
    [[nodiscard]] const std::vector<MeshEdge>& edges(std::size_t object) const {
        return meshes_[mesh_[object]].edges;
    }

  private:
    bool any_ = false;
    std::vector<std::uint32_t> first_;  ///< per object: index of its first part
    std::vector<std::size_t> mesh_;     ///< per object: index into meshes_
    struct OfMesh {
        std::vector<std::uint32_t> parts;
        std::vector<MeshEdge> edges;
    };
    std::vector<OfMesh> meshes_;  ///< the different meshes; the first is empty, for all other shapes
};

}  // namespace postlens
