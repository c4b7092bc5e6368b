// The nodes of a glTF document as a tree, with the placement and the motion of each node.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "scene/gltf/gltf_animation.h"
#include "scene/gltf/gltf_document.h"
#include "scene/scene_notes.h"

namespace postlens {

/// A node of the displayed glTF scene. If the node moves, `frame` is the animated node whose motion it
/// follows. This is the node itself if it is animated, or otherwise its nearest animated ancestor.
struct GltfNode {
    std::size_t index = 0;             ///< in the document
    glm::dmat4 world_from_node{1};     ///< at rest, that is without animations
    std::optional<std::size_t> frame;  ///< index in the document; empty if the node does not move
    glm::dmat4 frame_from_node{1};     ///< constant over time; the identity if there is no `frame`
};

class GltfNodes {
  public:
    /// Reads the nodes of the default scene, or of the first scene if there is no default.
    /// Parents precede their children. Translations are multiplied by `metres_per_unit`.
    /// Throws Error(invalid_input) if there is no scene, if the nodes do not form trees, or
    /// if more than 256 animated nodes are nested.
    GltfNodes(const GltfDocument& document, std::map<std::size_t, GltfNodeCurves> curves,
              double metres_per_unit, SceneNotes& notes);

    [[nodiscard]] const std::vector<GltfNode>& nodes() const { return nodes_; }
    /// Returns the world placement of the animated node `frame` at a time.
    [[nodiscard]] Placement frame_at(std::size_t frame, double time_s) const;
    /// Returns the keyframe times of the animated node `frame` and of its animated ancestors, ascending.
    [[nodiscard]] std::vector<double> frame_times_s(std::size_t frame) const;
    /// Returns how inaccurately a placement (translation, rotation, scale) represents the transform of the
    /// animated node number `frame`. There is an error if the transform contains shear. It is relative to the
    /// length of the longest column of the transform's matrix. The largest error over all keyframes is
    /// returned.
    [[nodiscard]] double frame_shear(std::size_t frame) const;

  private:
    struct Frame {
        std::optional<std::size_t> above;  // the nearest animated ancestor
        Placement above_from_parent;       // constant transform from this node's parent to `above`
        double shear = 0;  // error caused by shear in above_from_parent and in the node itself
        Placement own;     // the node's placement relative to its parent, at rest
        int depth = 0;     // number of animated nodes from the root to this node
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
