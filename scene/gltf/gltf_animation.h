// The animations of a glTF document: curves for the translation, rotation and scale of nodes.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "scene/gltf/gltf_accessor.h"
#include "scene/placement.h"
#include "scene/scene_notes.h"

namespace postlens {

/// An animation curve [gltf2, appendix C]. It is constant before the first keyframe and after the last.
struct GltfCurve {
    enum class Kind { step, linear, cubic_spline };
    Kind kind = Kind::linear;
    std::vector<double> times_s;  ///< ascending
    std::size_t components = 3;   ///< 4 for a rotation, which is a quaternion x, y, z, w
    std::vector<double> values;   ///< one per keyframe; cubic_spline: in-tangent, value, out-tangent

    /// Returns the interpolated value at a time. Rotations are unit quaternions.
    /// Linear curves interpolate rotations by slerp along the shorter arc. Cubic curves interpolate the
    /// components of a quaternion, so the resulting quaternion is normalised.
    [[nodiscard]] std::array<double, 4> at(double time_s) const;
};

/// The curves of one node.
struct GltfNodeCurves {
    std::optional<GltfCurve> translation, rotation, scale;
    /// Returns the node's placement (translation, rotation, scale) at a time. `own` provides the properties
    /// that have no curve.
    [[nodiscard]] Placement at(double time_s, const Placement& own) const;
    /// Returns the times of all keyframes of these curves, in s and ascending. A curve of the kind `step`
    /// jumps at its keyframes, but the caller interpolates between the returned times. Therefore, a time
    /// shortly before each jump is inserted: earlier by shortest_key_gap_s, or by half the distance to the
    /// previous keyframe if this is less.
    [[nodiscard]] std::vector<double> times_s() const;
};

/// Returns the animation curves of all animated nodes. The key is the index of the node in the document. All
/// animations of the document play at the same time. Translations are multiplied by `metres_per_unit`. Throws
/// Error(invalid_input).
/// `notes` gets a note to the user for each thing that is ignored:
/// - a second animation of the same property
/// - animations of morph weights
/// - KHR_animation_pointer
[[nodiscard]] std::map<std::size_t, GltfNodeCurves> read_gltf_animations(const GltfDocument& document,
                                                                         GltfAccessors& accessors,
                                                                         double metres_per_unit,
                                                                         SceneNotes& notes);

}  // namespace postlens
