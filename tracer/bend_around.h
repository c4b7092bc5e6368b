// Takes W.bend of a node from the samples around it where it is small there, which saves measuring it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "records/record.h"

namespace postlens {

/// Records of four point samples, laid out as in TracedSamples.
using SamplesAround = std::array<std::span<const Record>, 4>;

/// The node in question and the ids of the objects at which its path bounces, from the eye on.
struct ChainNode {
    NodePath path;
    std::uint32_t id = 0;
    bool hidden = false;                 ///< of a layer but the first
    std::span<const std::uint32_t> ids;  ///< as many as `path` has bounces
};

/// Largest W.bend of the nodes in the four samples that have the same path by the same objects, 1/m^2. Empty
/// if it may differ at the node in question, which is if a sample has no such node, if none of them lies on
/// the same object, or if the value exceeds `little` and is not about equal all around (the same object in
/// all four, values within a factor of two).
[[nodiscard]] std::optional<float> bend_around(const SamplesAround& around, const ChainNode& node,
                                               float little);

}  // namespace postlens
