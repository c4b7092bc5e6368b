// One surface at one pixel, from the sums of its parts: its own colour and what mirrors and glass show in it.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "focus/layer_splats.h"
#include "focus/visibility.h"

namespace postlens {

/// The sums of a part at a pixel.
struct LayerTerm {
    const LayerPart* part = nullptr;
    std::array<double, 3> rgb{};
    double weight = 0;
    double depth = 0;                  ///< weight times 1/z'
    std::array<LensMoment, 4> lens{};  ///< of colour and weight
    double covered = 0;                ///< of the weight: see LayerSplat
};

/// Below this sum of weights nothing is taken to have arrived.
inline constexpr double smallest_layer_weight = 1e-12;

/// The fragment of the surface that all terms are of; in the order of their parts. Nothing where the surface
/// itself does not arrive.
///
/// What a chain of bounces shows is a picture of its own, made of the chain's nodes with their own responses
/// and divided by their own weights; the share of the surface that has this chain, its mask, is blurred by
/// the surface's responses, so that the mirror's outline moves with the mirror and not with the image. Where
/// no node of the chain arrives but the mask does (beside the outline of a mirror that is more out of focus
/// than what it shows), the chain's colours as the mask's own responses spread them stand in.
[[nodiscard]] std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms,
                                                      const FocusGeometry& geometry);

}  // namespace postlens
