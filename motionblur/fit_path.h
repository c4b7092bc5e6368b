// Splines through tracks of many points: `--fit-paths PX`.
#pragma once

#include <span>

#include "motionblur/screen_path.h"

namespace postlens {

struct PathFit {
    ScreenPath path;
    double error_px = 0;  ///< the greatest distance at the given points, at equal times
};

/// The path with the fewest knots found that stays within `tolerance_px` of `points` at their times: one knot
/// where nothing moves, else Bezier curves in time with handles of their own at either side of a knot, so
/// that a bounce costs a knot and no more; the polyline of the points where no spline has fewer knots. Never
/// more knots than points.
///
/// Long curves are laid first, each as far as a cubic by least squares follows the points; then fewer knots
/// are tried, their number by bisection, and their places, handles and times moved by Ceres (`refine_path`),
/// for up to `most_refined_segments` of them. Deterministic. Takes seconds at most for 100'000 points.
///
/// Throws Error(wrong_arguments) "--fit-paths: ..." unless 0 < tolerance_px < infinity, and for points whose
/// times do not grow, that are not finite, none, or more than `most_knots`.
[[nodiscard]] PathFit fit_path(std::span<const PathPoint> points, double tolerance_px);

inline constexpr std::size_t most_refined_segments = 128;

}  // namespace postlens
