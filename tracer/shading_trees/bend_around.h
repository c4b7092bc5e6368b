// Estimates `w_bend` of a surface that is seen in a mirror or in glass. `w_bend` tells how nonlinearly the
// surface's image moves when the lens point moves. To measure it, additional rays must be traced from several
// lens points. The estimate saves these rays, because it uses the values that the records of nearby samples
// already contain.
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

/// Estimates `w_bend` of a surface hit `node` from four samples nearby. `w_bend`, in 1/m^2, measures how
/// nonlinearly the image of a surface moves when the lens point moves.
/// Only hits that are seen after the same bounces at the same objects as `node` are compared. The result is
/// their greatest value.
/// Empty if the value at `node` may be different:
/// - One of the samples has no such hit.
/// - No such hit lies on the same object as `node`.
/// - The greatest value exceeds `little`, and not all samples have a hit on the object of `node`.
/// - The greatest value exceeds `little`, and the values of the samples differ by more than a factor of two.
[[nodiscard]] std::optional<float> bend_around(const SamplesAround& around, const ChainNode& node,
                                               float little);

}  // namespace postlens
