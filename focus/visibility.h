// What covers what, where several blurred surfaces arrive at one pixel.
#pragma once

#include <array>
#include <span>

#include "lens/focus_geometry.h"

namespace postlens {

/// A sum over light, each part of it times the lens point (x and y of the raster, in radii of the lens) that
/// it came through.
struct LensMoment {
    double x = 0, y = 0;
};

/// Light of a surface at a pixel: its alpha, the share of the pixel's light that it would give, and its
/// colour times that; the moments of red, green, blue and alpha.
struct SurfaceLight {
    double alpha = 0;  ///< 0 or more
    std::array<double, 3> rgb{};
    std::array<LensMoment, 4> lens{};
};

/// A surface at a pixel: what the pinhole sees of it, and what the pinhole has hidden behind something.
struct Fragment {
    double inverse_depth_per_m = 0;  ///< mean 1/z'
    SurfaceLight seen, hidden;
    double covered = 0;  ///< of the hidden alpha: what stays hidden, as what hides it moves along
};

/// How independently two surfaces move over the lens, 0..1, by the signed radii of their circles, px. Below
/// about a pixel the pixel's own width decides.
[[nodiscard]] double independence(double radius_px, double other_px);

/// The pixel's colour: its fragments laid over each other, divided by what of the pixel they fill together.
/// Of fragments of positive alpha; black without any. Sorts them, nearest first, and of those in one plane
/// the smallest.
///
/// What is laid down holds back the light behind it: "over" [porter1984], but of the light of single lens
/// points, not of all the lens at once. What is still free is kept as a linear function over the lens, and so
/// is each surface, by its moments; q is spread evenly over the unit disc, with a variance of 1/4 along each
/// axis, so
///     T(q) = t + 4 t_q . q,  mean of T(q) E(q) = t e + 4 t_q . e_q,
/// where e and e_q are a colour and its moment. Where a blurred edge covers one side of the lens, what shines
/// through the other side is seen whole. Without moments this is plain "over".
///
/// Besides, two surfaces with the same circle of confusion move together: there the pinhole's picture stays
/// true wherever on the lens one looks from. So what the pinhole sees of a surface is not held back by
/// surfaces that move along with it (see independence), and what is hidden by such a one is left out
/// (Fragment::covered).
[[nodiscard]] std::array<double, 3> composite(std::span<Fragment> fragments, const FocusGeometry& geometry);

}  // namespace postlens
