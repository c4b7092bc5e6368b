// The animations of a glTF document. They are curves for the translation, rotation and scale of nodes.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "scene/gltf/gltf_accessor.h"
#include "scene/placement.h"
#include "scene/scene_notes.h"

namespace postlens {

/// An animation curve [gltf2, appendix C]. Its value is constant before the first keyframe and after the
/// last.
struct GltfCurve {
    enum class Kind { step, linear, cubic_spline };
    Kind kind = Kind::linear;
    std::vector<double> times_s;  ///< ascending
    std::size_t components = 3;   ///< 4 for a rotation, which is a quaternion x, y, z, w
    std::vector<double> values;   ///< one per keyframe; cubic_spline: in-tangent, value, out-tangent

    /// Returns the value at a time. Rotations have unit length. If the curve is linear, rotations are
    /// interpolated by slerp along the shorter arc. If it is cubic, the interpolated quaternion is
    /// normalised.
    [[nodiscard]] std::array<double, 4> at(double time_s) const;
};

/// The curves of one node.
struct GltfNodeCurves {
    std::optional<GltfCurve> translation, rotation, scale;
    /// Returns the node's placement (translation, rotation, scale) at a time. `own` provides the components
    /// that have no curve.
    [[nodiscard]] Placement at(double time_s, const Placement& own) const;
    /// Returns the times of all keyframes, ascending. A step curve jumps at every keyframe except the first.
    /// For each jump, an additional time is returned, which is shortest_key_gap_s before the jump.
    [[nodiscard]] std::vector<double> times_s() const;
};

/// Reads the curves of all animated nodes. Returns the curves of each node, by index of the node. All
/// animations of the document play at the same time. If two animations affect the same property of a node,
/// the first one is used, with a note to the user. Animations of morph weights and KHR_animation_pointer are
/// ignored, also with a note. Translations are multiplied by `metres_per_unit`. Throws Error(invalid_input).
[[nodiscard]] std::map<std::size_t, GltfNodeCurves> read_gltf_animations(const GltfDocument& document,
                                                                         GltfAccessors& accessors,
                                                                         double metres_per_unit,
                                                                         SceneNotes& notes);

}  // namespace postlens
