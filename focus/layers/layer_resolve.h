// Computes the light of one surface at one pixel: its own radiance and the light that it reflects and
// transmits.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// The sums at one pixel of all splats (impulse responses) of one LayerPart. A LayerPart is a surface itself,
/// or the light that the surface reflects or transmits along one path.
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

/// Computes the light of a surface at a pixel (Fragment) from the sums of all its parts. The parts are the
/// surface's own light and the light that it shows along each path (sequence of reflections and
/// transmissions). The sums must be in the order of LayerPart. Returns nothing if no light of the surface
/// itself reaches the pixel.
///
/// The nodes of each path form an image of their own. They are scattered with their own kernels and divided
/// by their own weights. The mask of a path is the share of the surface that shows this path. It is scattered
/// with the surface's kernels, so that the outline of a mirror is blurred like the mirror and not like the
/// reflection.
///
/// If a mirror is more out of focus than its reflection, its blurred mask may reach pixels that no node of
/// the reflection reaches. In these pixels, the path's colours are scattered with the mask's kernels instead.
[[nodiscard]] std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms,
                                                      const FocusGeometry& geometry);

}  // namespace postlens
