// Estimates `w_bend`, the nonlinear motion of a surface's image over the lens, from samples nearby.
// This saves rays. The matrix W describes the linear motion.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "records/record.h"

namespace postlens {

/// Records of four point samples, stored as in TracedSamples.
using SamplesAround = std::array<std::span<const Record>, 4>;

/// A surface hit after reflections or refractions, and the ids of the objects that reflected or refracted.
struct ChainNode {
    NodePath path;
    std::uint32_t id = 0;
    bool hidden = false;                 ///< the node's layer is not 0
    std::span<const std::uint32_t> ids;  ///< one per bounce of `path`
};

/// Estimates `w_bend`, 1/m^2, the nonlinear motion of a surface's image over the lens, from four samples
/// nearby.
/// It is the greatest value of similar surface hits, with bounces at the same objects as `node`.
/// Empty if the value at `node` may be different:
/// - A sample has no similar hit.
/// - No similar hit lies on the object of `node`.
/// - The greatest value exceeds `little`, and the samples do not agree within a factor of two on this object.
[[nodiscard]] std::optional<float> bend_around(const SamplesAround& around, const ChainNode& node,
                                               float little);

}  // namespace postlens
