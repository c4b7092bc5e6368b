// Compositing of several blurred surfaces at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// The moment of some light over the lens: the sum of the light, multiplied by the lens point through which
/// it passes, in lens radii from the lens's centre. It points to the side of the lens through which more
/// light passes.
struct LensMoment {
    double x = 0, y = 0;
};

/// Tells through which side of the lens a surface's light arrives, by a moment (LensMoment) of its colour and
/// a moment of its alpha. Red, green and blue share a moment, because the hue of a surface varies little over
/// the lens.
struct LensMoments {
    LensMoment rgb;  ///< of red + green + blue
    LensMoment alpha;
};

/// Light of a blurred surface at a pixel, as if nothing were in front.
/// - `alpha`: fraction of the pixel that the surface covers, averaged over the lens; may exceed 1 if several
///   samples of the surface overlap
/// - `rgb`: colour times alpha
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

/// A blurred surface at a pixel. Its light has two parts: the light of the points that the pinhole sees,
/// `seen`, and the light of the points that are hidden from the pinhole, `hidden`. They are stored
/// separately, because nearer surfaces block more of the hidden part.
struct Fragment {
    double inverse_depth_per_m = 0;  ///< mean 1/z'
    SurfaceLight seen, hidden;
    double covered = 0;  ///< part of hidden.alpha that no lens point sees, because its occluder moves with it
};

/// Returns how differently two surfaces shift in the image when the lens point moves, from 0 (together) to 1
/// (independently). For their signed CoC radii r1 and r2, in px, it is:
///
///     min(1, |r1 - r2| / (max(|r1|, |r2|) + 1))
[[nodiscard]] double independence(double radius_px, double other_px);

/// Sorts the surfaces of a pixel, composites them with "over" [porter1984], and divides by the coverage. All
/// alphas must be positive.
[[nodiscard]] std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry);

}  // namespace postlens
