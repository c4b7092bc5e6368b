// Computes the light of one blurred surface at one pixel: its own radiance, and the light that it reflects
// and transmits.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// The blurred light that one part of the scene adds to a pixel, summed over all samples of this part. The
/// part is either a surface, or a reflected or transmitted image that a surface shows.
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

/// Returns the light that a directly visible surface sends to a pixel, including what it reflects and
/// transmits. Returns nothing if the surface's blur does not reach the pixel.
/// - `terms`: the blurred light of the surface and of each image that it shows, sorted by LayerTerm::part
[[nodiscard]] std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms,
                                                      const FocusGeometry& geometry);

}  // namespace postlens
