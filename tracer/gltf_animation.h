// The animations of a glTF document: curves of the nodes' translations, rotations and scales.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "tracer/gltf_accessor.h"
#include "tracer/placement.h"
#include "tracer/scene_notes.h"

namespace postlens {

/// One curve [gltf2, appendix C]; before the first and after the last key it is constant.
struct GltfCurve {
    enum class Kind { step, linear, cubic_spline };
    Kind kind = Kind::linear;
    std::vector<double> times_s;  ///< growing
    std::size_t components = 3;   ///< 4: a rotation x, y, z, w
    std::vector<double> values;   ///< per key; cubic_spline: tangent in, value, tangent out

    /// The value at an instant; rotations are of unit length (linear: slerp, the short way; cubic:
    /// normalised).
    [[nodiscard]] std::array<double, 4> at(double time_s) const;
};

/// The curves of one node.
struct GltfNodeCurves {
    std::optional<GltfCurve> translation, rotation, scale;
    /// What they make of the node's own placement.
    [[nodiscard]] Placement at(double time_s, const Placement& own) const;
    /// The instants of all keys, growing; before each key of a step, shortest_key_gap_s earlier, one more.
    [[nodiscard]] std::vector<double> times_s() const;
};

/// By node. All animations of the document play at once; where two move the same of a node the first counts,
/// with a note. Morph weights and pointers are left out with a note. Translations are multiplied by
/// `metres_per_unit`. Throws Error(invalid_input).
[[nodiscard]] std::map<std::size_t, GltfNodeCurves> read_gltf_animations(const GltfDocument& document,
                                                                         GltfAccessors& accessors,
                                                                         double metres_per_unit,
                                                                         SceneNotes& notes);

}  // namespace postlens
