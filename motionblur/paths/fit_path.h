// Fits splines to paths of many points (`--fit-paths`).
#pragma once

#include <span>

#include "motionblur/paths/screen_path.h"

namespace postlens {

struct PathFit {
    ScreenPath path;
    double error_px = 0;  ///< largest distance from the given points at their times, px
};

/// Finds a path with few knots that stays within `tolerance_px` of `points` at their times. It consists of
/// Bezier curves in time, or of the points' polyline if no spline has fewer knots. It has one knot if the
/// points do not move.
///
/// First, segments are placed one after another. If there are at most `most_refined_segments`, bisection then
/// tries fewer knots, optimised with Ceres (`refine_path`). The time is at most a few seconds for 100'000
/// points. The result is deterministic.
///
/// Throws Error(wrong_arguments) "--fit-paths: ..." unless 0 < tolerance_px < infinity, and 1 to `most_knots`
/// points are finite and in increasing order of time.
[[nodiscard]] PathFit fit_path(std::span<const PathPoint> points, double tolerance_px);

inline constexpr std::size_t most_refined_segments = 128;

}  // namespace postlens
