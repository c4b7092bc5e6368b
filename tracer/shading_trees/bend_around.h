// Estimates `w_bend` of a node from samples around it, which saves rays.
// `w_bend` is the second-order motion of the node's image over the lens. W is the first order.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "records/record.h"

namespace postlens {

/// Records of four point samples, stored as in TracedSamples.
using SamplesAround = std::array<std::span<const Record>, 4>;

/// A node, and the ids of the objects at which its path reflects or transmits, in order from the eye.
struct ChainNode {
    NodePath path;
    std::uint32_t id = 0;
    bool hidden = false;                 ///< the node's layer is not 0
    std::span<const std::uint32_t> ids;  ///< one per bounce of `path`
};

/// Estimates the `w_bend` of `node`, 1/m^2, as the greatest of similar nodes in the four samples.
/// Similar nodes have the same path and bounced at the same objects.
/// Empty if the value at `node` may be different:
/// - A sample has no similar node.
/// - No similar node lies on the object of `node`.
/// - The greatest value exceeds `little`, and the samples do not agree within a factor of two on this object.
[[nodiscard]] std::optional<float> bend_around(const SamplesAround& around, const ChainNode& node,
                                               float little);

}  // namespace postlens
