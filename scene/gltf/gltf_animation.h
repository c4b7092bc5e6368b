// The animations of a glTF document: curves of the nodes' translations, rotations and scales.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "scene/gltf/gltf_accessor.h"
#include "scene/placement.h"
#include "scene/scene_notes.h"

namespace postlens {

/// One animation curve [gltf2, appendix C]. Its value is constant before the first key and after the last.
struct GltfCurve {
    enum class Kind { step, linear, cubic_spline };
    Kind kind = Kind::linear;
    std::vector<double> times_s;  ///< ascending
    std::size_t components = 3;   ///< 4: a rotation, as quaternion x, y, z, w
    std::vector<double> values;   ///< per key; for a cubic_spline: incoming tangent, value, outgoing tangent

    /// Returns the value at an instant. Rotations have unit length. Linear rotations are interpolated by
    /// slerp along the shorter arc; cubic ones are normalised.
    [[nodiscard]] std::array<double, 4> at(double time_s) const;
};

/// The curves of one node.
struct GltfNodeCurves {
    std::optional<GltfCurve> translation, rotation, scale;
    /// Returns the placement of the node at an instant. Components without a curve are taken from `own`.
    [[nodiscard]] Placement at(double time_s, const Placement& own) const;
    /// Returns the instants of all keys, ascending. A step curve jumps at each key but the first, so it has
    /// another instant shortest_key_gap_s before each of these keys.
    [[nodiscard]] std::vector<double> times_s() const;
};

/// Reads the curves of all animated nodes, by index of the node. All animations of the document play at the
/// same time. If two of them animate the same property of a node, the first is used and a note is made.
/// Animations of morph weights and KHR_animation_pointer are ignored, with a note to the user. Translations
/// are multiplied by `metres_per_unit`. Throws Error(invalid_input).
[[nodiscard]] std::map<std::size_t, GltfNodeCurves> read_gltf_animations(const GltfDocument& document,
                                                                         GltfAccessors& accessors,
                                                                         double metres_per_unit,
                                                                         SceneNotes& notes);

}  // namespace postlens
