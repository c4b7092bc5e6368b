// What covers what, where several blurred surfaces arrive at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// A surface at a pixel: the share of the pixel's light that it would give (alpha) and its colour times
/// that, apart for what the pinhole sees of it and for what the pinhole has hidden behind something.
struct Fragment {
    float inverse_depth_per_m = 0;  ///< mean 1/z'
    float seen = 0, hidden = 0;     ///< alpha, 0 or more
    std::array<float, 3> seen_rgb{}, hidden_rgb{};
};

/// The pixel's colour: its fragments laid over each other, divided by what of the pixel they fill together.
/// Of fragments of positive alpha; black without any. Sorts them, nearest first; the order of equals counts.
///
/// Two surfaces at different depths are moved past each other by every other point of the lens: that one
/// covers the other happens as often as their alphas say, and what is behind keeps 1 - alpha ("over"
/// [porter1984]). Two surfaces with the same circle of confusion move together: there the pinhole's picture
/// stays true wherever on the lens one looks from, and what is behind keeps exactly what the pinhole sees of
/// it. In between, where their radii differ by less than the larger one and a pixel, both are mixed.
[[nodiscard]] std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry);

}  // namespace postlens
