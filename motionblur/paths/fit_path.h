// Fits splines to paths of many points: option `--fit-paths PX`.
#pragma once

#include <span>

#include "motionblur/paths/screen_path.h"

namespace postlens {

struct PathFit {
    ScreenPath path;
    double error_px = 0;  ///< largest distance from the given points at their times
};

/// Finds a path with few knots that stays within `tolerance_px` of `points` at their times. Points that do
/// not move give one knot. All others give Bezier curves in time, with separate handles on the two sides of a
/// knot, so that a bounce needs only one knot. If no spline has fewer knots than the polyline of the points,
/// that is returned. The path never has more knots than points.
///
/// First, segments are laid one after the other, each as long as a least-squares cubic follows the points.
/// Then bisection tries fewer knots, whose positions, handles and times Ceres optimises (`refine_path`). This
/// second step is taken for up to `most_refined_segments` segments. Deterministic. Takes at most seconds for
/// 100'000 points.
///
/// Throws Error(wrong_arguments) "--fit-paths: ..." unless 0 < tolerance_px < infinity, and for points that
/// are not finite, whose times do not increase, or whose number is 0 or above `most_knots`.
[[nodiscard]] PathFit fit_path(std::span<const PathPoint> points, double tolerance_px);

inline constexpr std::size_t most_refined_segments = 128;

}  // namespace postlens
