// Optimises the knots of a path of Bezier curves so that it follows given points closely.
#pragma once

#include <span>
#include <vector>

#include "motionblur/paths/screen_path.h"

namespace postlens {

/// Largest distance between the path and the points at the times of the points, px.
[[nodiscard]] double greatest_error_px(const ScreenPath& path, std::span<const PathPoint> points);

/// Finds positions, handles and times of the knots of a Bezier path that minimise its largest distance from
/// the points. `times_s`: initial times of the knots, at least 2, increasing; the first and the last are
/// those of the points. Stops when the largest distance is at most `tolerance_px` or no longer decreases.
/// Distances above the tolerance enter the loss with their fourth power, so that the largest ones dominate.
/// Returns the best knots found.
[[nodiscard]] std::vector<PathKnot> refine_path(std::span<const PathPoint> points,
                                                const std::vector<double>& times_s, double tolerance_px);

}  // namespace postlens
