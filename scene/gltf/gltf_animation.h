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

/// One animation curve [gltf2, appendix C]. It is constant before its first and after its last key.
struct GltfCurve {
    enum class Kind { step, linear, cubic_spline };
    Kind kind = Kind::linear;
    std::vector<double> times_s;  ///< ascending
    std::size_t components = 3;   ///< 4: a rotation, as quaternion x, y, z, w
    std::vector<double> values;   ///< per key; cubic_spline: tangent in, value, tangent out

    /// The value at an instant. Rotations have unit length: linear ones are interpolated by slerp along the
    /// shorter arc, cubic ones are normalised.
    [[nodiscard]] std::array<double, 4> at(double time_s) const;
};

/// The curves of one node.
struct GltfNodeCurves {
    std::optional<GltfCurve> translation, rotation, scale;
    /// The node's placement at an instant. Components without a curve are those of `own`.
    [[nodiscard]] Placement at(double time_s, const Placement& own) const;
    /// The instants of all keys, ascending. Every key of a step curve but the first has one more instant,
    /// shortest_key_gap_s before it.
    [[nodiscard]] std::vector<double> times_s() const;
};

/// The curves of all animated nodes, by index of the node. All animations of the document play at once; where
/// two animate the same property of a node, the first is used, with a note. Morph weights and pointers are
/// left out with a note. Translations are multiplied by `metres_per_unit`. Throws Error(invalid_input).
[[nodiscard]] std::map<std::size_t, GltfNodeCurves> read_gltf_animations(const GltfDocument& document,
                                                                         GltfAccessors& accessors,
                                                                         double metres_per_unit,
                                                                         SceneNotes& notes);

}  // namespace postlens
