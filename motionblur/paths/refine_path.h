// Optimises the knots of a path of Bezier curves so that it follows given points closely.
#pragma once

#include <span>
#include <vector>

#include "motionblur/paths/screen_path.h"

namespace postlens {

/// Returns the largest distance, in px, between the path and the points at the times of the points.
[[nodiscard]] double greatest_error_px(const ScreenPath& path, std::span<const PathPoint> points);

/// Finds the knots of a Bezier path that minimise the path's largest distance from the points. Positions,
/// handles and times of the knots are optimised. `times_s` contains the initial times of at least 2 knots, in
/// increasing order. The first and the last time are those of the first and last point.
///
/// Stops when the largest distance is at most `tolerance_px` or no longer decreases. Distances above the
/// tolerance contribute their fourth power to the loss, so that the largest distances dominate. Returns the
/// best knots that were found.
[[nodiscard]] std::vector<PathKnot> refine_path(std::span<const PathPoint> points,
                                                const std::vector<double>& times_s, double tolerance_px);

}  // namespace postlens
