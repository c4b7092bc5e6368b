// One surface at one pixel, from the sums of its parts: its own radiance and what it reflects and transmits.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// The sums of the splats of one part (LayerPart: a surface, or what it reflects or transmits) at a pixel.
struct LayerTerm {
    const LayerPart* part = nullptr;
    std::array<double, 3> rgb{};
    double weight = 0;
    double depth = 0;                  ///< weight times 1/z'
    std::array<LensMoment, 4> lens{};  ///< of colour and weight
    double covered = 0;                ///< LayerSplat::covered
};

/// A smaller sum of weights counts as none.
inline constexpr double smallest_layer_weight = 1e-12;

/// Computes the light of a surface at a pixel (Fragment) from the sums of all its parts, in the order of the
/// parts. None if no light of the surface itself arrives at the pixel.
///
/// The nodes of each path (sequence of reflections and transmissions) form an image of their own: they are
/// scattered with their own kernels and divided by their own weights. The share of the surface that shows
/// this path, its mask, is scattered with the surface's kernels, so that a mirror's outline is blurred as the
/// mirror and not as its reflection.
///
/// The mask may arrive at a pixel that no node of the path reaches, for example beside the outline of a
/// mirror that is more out of focus than its reflection. There the path's colours, scattered with the mask's
/// kernels, replace them.
[[nodiscard]] std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms,
                                                      const FocusGeometry& geometry);

}  // namespace postlens
