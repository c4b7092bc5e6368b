// The tree of nodes of a glTF document: where each stands, and how it moves.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "tracer/gltf_animation.h"
#include "tracer/gltf_document.h"
#include "tracer/scene_notes.h"

namespace postlens {

/// A node of the scene that is shown. `frame` is the nearest node that moves, this one or one above it.
struct GltfNode {
    std::size_t index = 0;             ///< in the document
    glm::dmat4 world_from_node{1};     ///< at rest: without animations
    std::optional<std::size_t> frame;  ///< index in the document; none: it stands still
    glm::dmat4 frame_from_node{1};     ///< constant; 1 without a frame
};

class GltfNodes {
  public:
    /// The nodes of the document's scene (its default, else the first), each after the one above it.
    /// Translations are multiplied by `metres_per_unit`. Throws Error(invalid_input) where there is no scene,
    /// where nodes do not form trees, or more than 256 that move stand above one another.
    GltfNodes(const GltfDocument& document, std::map<std::size_t, GltfNodeCurves> curves,
              double metres_per_unit, SceneNotes& notes);

    [[nodiscard]] const std::vector<GltfNode>& nodes() const { return nodes_; }
    /// Where a frame stands at an instant.
    [[nodiscard]] Placement frame_at(std::size_t frame, double time_s) const;
    /// The instants at which the motion of a frame, or of one above it, has keys; growing.
    [[nodiscard]] std::vector<double> frame_times_s(std::size_t frame) const;
    /// The greatest error that a frame has from shearing, as a share of its size, at the instants of its
    /// keys.
    [[nodiscard]] double frame_shear(std::size_t frame) const;

  private:
    struct Frame {
        std::optional<std::size_t> above;  // the next frame upwards
        Placement above_from_parent;       // what stands still between the two
        double shear = 0;                  // of that
        Placement own;
        int depth = 0;
    };
    void add(std::size_t index, const GltfNode* parent, double unit);
    [[nodiscard]] Decomposed placed(std::size_t frame, double time_s) const;

    const GltfDocument& d_;
    std::map<std::size_t, GltfNodeCurves> curves_;
    std::map<std::size_t, Frame> frames_;
    std::vector<GltfNode> nodes_;
    SceneNotes& notes_;
};

}  // namespace postlens
