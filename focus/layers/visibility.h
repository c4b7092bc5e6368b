// Compositing of several blurred surfaces at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// First moment over the lens: the sum of light times the lens point through which it passed. Lens points are
/// in lens radii, along the axes of the raster.
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

/// A surface at a pixel, divided into the part that the pinhole sees and the hidden part.
struct Fragment {
    double inverse_depth_per_m = 0;  ///< mean 1/z'
    SurfaceLight seen, hidden;
    double covered = 0;  ///< part of hidden.alpha that no lens point sees, because its occluder moves with it
};

/// Returns how independently two surfaces move when the lens point moves, from 0 to 1. r1 and r2 are the
/// signed radii of their circles of confusion, and 1 is the width of a pixel, in px:
///
///     min(1, |r1 - r2| / (max(|r1|, |r2|) + 1))
[[nodiscard]] double independence(double radius_px, double other_px);

/// Composites the fragments (surfaces) of a pixel and divides by their total coverage. Each must have
/// positive alpha. Without fragments the result is black. Sorts the fragments by depth, nearest first.
/// Fragments in one plane are sorted by alpha, smallest first.
///
/// The result is "over" [porter1984], applied at each lens point q. T(q) is the transmittance in front of a
/// fragment, E(q) its light. Both are linear in q, with the means t and e and the moments t_q and e_q. As q
/// is uniform over the unit disc (variance 1/4 along each axis):
///
///     T(q) = t + 4 t_q . q,  mean of T(q) E(q) = t e + 4 t_q . e_q.
///
/// A blurred edge that covers one side of the lens thus attenuates only light through that side.
///
/// Surfaces with the same circle of confusion move together when the lens point moves. They thus do not
/// attenuate each other's visible parts (see independence), and their hidden parts stay hidden
/// (Fragment::covered).
[[nodiscard]] std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry);

}  // namespace postlens
