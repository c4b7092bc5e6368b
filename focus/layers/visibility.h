// Compositing of several blurred surfaces at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// First moment over the lens: the sum of light times the lens point through which it passed (raster axes,
/// lens radii).
struct LensMoment {
    double x = 0, y = 0;
};

/// Light of a surface at a pixel, without occlusion. `alpha` is the mean over the lens of the surface's
/// coverage of the pixel, `rgb` its colour times alpha. `lens` contains the lens moments of red, green, blue
/// and alpha.
struct SurfaceLight {
    double alpha = 0;  ///< 0 or more
    std::array<double, 3> rgb{};
    std::array<LensMoment, 4> lens{};

    void divide(double by) {
        alpha /= by;
        for (double& channel : rgb) channel /= by;
        for (LensMoment& moment : lens) moment = {moment.x / by, moment.y / by};
    }
};

/// A surface at a pixel, separated into the part that the pinhole sees and the part that it does not see.
struct Fragment {
    double inverse_depth_per_m = 0;  ///< mean 1/z'
    SurfaceLight seen, hidden;
    double covered = 0;  ///< part of hidden.alpha that no lens point sees, because its occluder moves with it
};

/// Measures how independently two surfaces move over the lens, from 0 to 1: |r1 - r2| / (max(|r1|, |r2|) +
/// 1), at most 1. r1 and r2 are the signed radii of their circles of confusion, px. The 1 is the width of a
/// pixel.
[[nodiscard]] double independence(double radius_px, double other_px);

/// Composites the fragments of a pixel, one per surface, and divides by their total coverage. Fragments must
/// have positive alpha. Without fragments the result is black. The fragments are sorted: nearest first; in
/// one plane, smallest alpha first.
///
/// The result is "over" [porter1984], applied at each lens point. The transmittance T(q) of the fragments so
/// far and the light E(q) of a fragment are linear functions of the lens point q. Their means are t and e,
/// their moments t_q and e_q. q is distributed uniformly over the unit disc, whose variance is 1/4 along each
/// axis. Therefore
///     T(q) = t + 4 t_q . q,  mean of T(q) E(q) = t e + 4 t_q . e_q.
/// A blurred edge that covers one side of the lens thus does not attenuate light that passes through the
/// other side. If all moments are 0, this is plain "over".
///
/// Surfaces with the same circle of confusion move together over the lens, so every lens point sees the same
/// parts of them as the pinhole. The visible part of a surface is therefore not attenuated by surfaces that
/// move with it (see independence). A part that such a surface hides stays hidden (Fragment::covered).
[[nodiscard]] std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry);

}  // namespace postlens
