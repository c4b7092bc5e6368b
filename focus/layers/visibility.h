// Compositing of several blurred surfaces at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// First moment over the lens: the sum of light times the lens point through which the light passed. Lens
/// points are in lens radii, along the axes of the raster.
struct LensMoment {
    double x = 0, y = 0;
};

/// Lens moments of a surface's light. The colour channels share one moment: where one side of the lens sees
/// another colour than the other side, the brightness differs far more than the hue.
struct LensMoments {
    LensMoment rgb;  ///< of red + green + blue
    LensMoment alpha;
};

/// Light of a surface at a pixel, without occlusion. `alpha` is the share of the pixel that the surface
/// covers, as a mean over the lens. `rgb` is the colour times alpha.
struct SurfaceLight {
    double alpha = 0;  ///< 0 or more
    std::array<double, 3> rgb{};
    LensMoments lens{};

    void divide(double by) {
        alpha /= by;
        for (double& channel : rgb) channel /= by;
        for (LensMoment* moment : {&lens.rgb, &lens.alpha}) *moment = {moment->x / by, moment->y / by};
    }
};

/// A surface at a pixel, divided into the part that the pinhole sees and the part that it does not see.
struct Fragment {
    double inverse_depth_per_m = 0;  ///< mean 1/z'
    SurfaceLight seen, hidden;
    double covered = 0;  ///< part of hidden.alpha that no lens point sees, because its occluder moves with it
};

/// Returns how independently two surfaces move when the lens point moves, from 0 to 1. The arguments are r1
/// and r2, the signed radii of their circles of confusion, in px. The value is |r1 - r2| / (max(|r1|, |r2|) +
/// 1), but at most 1. The 1 in the denominator is the width of a pixel.
[[nodiscard]] double independence(double radius_px, double other_px);

/// Composites the fragments of a pixel, one per surface, and divides by their total coverage. Fragments must
/// have positive alpha. Without fragments the result is black. The fragments are sorted by depth, nearest
/// first. Fragments in one plane are sorted by alpha, smallest first.
///
/// The result is "over" [porter1984], applied at each lens point q. T(q) is the transmittance of the
/// fragments in front, and E(q) is the light of a fragment. Both are linear functions of q, with the means t
/// and e and the moments t_q and e_q. The lens points are distributed uniformly over the unit disc, whose
/// variance is 1/4 along each axis. Therefore
///     T(q) = t + 4 t_q . q,  mean of T(q) E(q) = t e + 4 t_q . e_q.
/// A blurred edge that covers one side of the lens thus does not attenuate light that passes through the
/// other side. If all moments are 0, the result is plain "over".
///
/// Surfaces with the same circle of confusion move together when the lens point moves. Every lens point then
/// sees the same parts of them as the pinhole. The visible part of a surface is therefore not attenuated by
/// surfaces that move with it (see independence). A part that such a surface hides stays hidden
/// (Fragment::covered).
[[nodiscard]] std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry);

}  // namespace postlens
