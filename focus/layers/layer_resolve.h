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

/// Computes the light of a surface at a pixel from the sums of its parts: its own light, and the light of
/// each path (sequence of reflections and transmissions). The sums must be in the order of LayerPart. Returns
/// nothing if no light of the surface itself reaches the pixel.
///
/// The nodes of a path form an image of their own, scattered with their own kernels. The mask of a path is
/// the share of the surface that shows it. The mask is scattered with the surface's kernels, so that the
/// outline of a mirror is blurred like the mirror.
///
/// The blurred mask of a mirror may reach pixels that no node of the reflection reaches. There, the
/// reflection's colours are scattered with the mask's kernels.
[[nodiscard]] std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms,
                                                      const FocusGeometry& geometry);

}  // namespace postlens
