// Optimises the knots of a Bezier path to follow given points.
#pragma once

#include <span>
#include <vector>

#include "motionblur/paths/screen_path.h"

namespace postlens {

/// Returns the largest distance, in px, between a point and the path's position at the point's time.
[[nodiscard]] double greatest_error_px(const ScreenPath& path, std::span<const PathPoint> points);

/// Fits a Bezier path to `points`, so that the largest distance between the path and a point becomes small.
/// At first, the path has knots at `times_s`, of which there must be at least 2. The fit then moves the knots
/// in position and time. It stops when the largest distance is at most `tolerance_px` or no longer decreases.
///
/// The fit minimises a sum over the points. A distance up to the tolerance counts by its square. A larger
/// distance counts by its fourth power, so that the largest distance dominates the sum.
[[nodiscard]] std::vector<PathKnot> refine_path(std::span<const PathPoint> points,
                                                const std::vector<double>& times_s, double tolerance_px);

}  // namespace postlens
