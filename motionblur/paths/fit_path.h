// Fits splines to paths of many points (`--fit-paths`).
#pragma once

#include <span>

#include "motionblur/paths/screen_path.h"

namespace postlens {

struct PathFit {
    ScreenPath path;
    double error_px = 0;  ///< largest distance from the given points at their times, px
};

/// Finds a path with few knots that stays within `tolerance_px` of `points` at their times. If the points do
/// not move, the path has one knot. Otherwise it consists of Bezier curves in time. The handles on the two
/// sides of a knot are independent, so a bounce needs only one knot. If no spline has fewer knots than the
/// polyline of the points, the polyline is returned. The result is deterministic.
///
/// First, segments are placed one after another. Each is as long as a least-squares cubic can follow its
/// points. If there are at most `most_refined_segments` segments, bisection then tries fewer knots, whose
/// positions, handles and times are optimised with Ceres (`refine_path`). The time is at most a few seconds
/// for 100'000 points.
///
/// Throws Error(wrong_arguments) "--fit-paths: ..." unless 0 < tolerance_px < infinity. Throws the same error
/// for points that are not finite, for times that do not increase, and if the number of points is 0 or above
/// `most_knots`.
[[nodiscard]] PathFit fit_path(std::span<const PathPoint> points, double tolerance_px);

inline constexpr std::size_t most_refined_segments = 128;

}  // namespace postlens
