// Compositing of several blurred surfaces at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// The moment of some light over the lens: the sum over all its parts, each multiplied by the lens point
/// through which it passes, in lens radii from the lens's centre. It shows on which side of the lens the
/// light is concentrated. It is 0 if the light passes evenly through the lens.
struct LensMoment {
    double x = 0, y = 0;
};

/// Two moments of a surface's light over the lens (LensMoment), one of its colour and one of its alpha. They
/// tell through which side of the lens the light arrives. One moment serves red, green and blue together,
/// because the hue of a surface varies little over the lens.
struct LensMoments {
    LensMoment rgb;  ///< of red + green + blue
    LensMoment alpha;
};

/// Light of a blurred surface at a pixel, as if nothing were in front.
/// - `alpha`: fraction of the pixel that the surface covers, averaged over the lens
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

/// A blurred surface at a pixel, divided into its points that the pinhole sees and its points that are hidden
/// from the pinhole.
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
