// W.bend of a node as the same chain has it in point samples around, where it is so little that it need not
// be measured.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "records/record.h"

namespace postlens {

/// Records of four point samples, each as TracedSamples has them.
using SamplesAround = std::array<std::span<const Record>, 4>;

/// What is asked about: a node seen behind bounces at `ids`, the eye's first.
struct ChainNode {
    NodePath path;
    std::uint32_t id = 0;
    bool hidden = false;                 ///< of a layer but the first
    std::span<const std::uint32_t> ids;  ///< as many as `path` has bounces
};

/// The greatest W.bend of the nodes around that are seen by the same path in the same objects, 1/m^2. None
/// where that does not tell what it is here: a sample has no such node, or none shows the same object, or it
/// is more than `little` and not about the same all around: of the same object in all four samples, within a
/// factor of two.
[[nodiscard]] std::optional<float> bend_around(const SamplesAround& around, const ChainNode& node,
                                               float little);

}  // namespace postlens
