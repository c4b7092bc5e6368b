// Computes the light of one surface at one pixel: its own radiance, and the light that it reflects and
// transmits.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// The sums at one pixel of all splats (impulse responses) of one LayerPart: a surface, or what it reflects
/// or transmits along one path.
struct LayerTerm {
    const LayerPart* part = nullptr;
    std::array<double, 3> rgb{};
    double weight = 0;
    double depth = 0;    ///< weight times 1/z'
    LensMoments lens{};  ///< alpha is the moment of the weight
    double covered = 0;  ///< LayerSplat::covered
};

/// A sum of weights below this counts as 0.
inline constexpr double smallest_layer_weight = 1e-12;

/// Computes the light of a surface at a pixel: its own light, and the light of each path (sequence of
/// reflections and transmissions). `terms` must be in the order of LayerPart. Returns nothing if no light of
/// the surface itself reaches the pixel.
///
/// A mask is the share of a surface that shows a path. It is blurred like the surface, so that the outline of
/// a mirror does not get the blur of its reflection.
[[nodiscard]] std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms,
                                                      const FocusGeometry& geometry);

}  // namespace postlens
