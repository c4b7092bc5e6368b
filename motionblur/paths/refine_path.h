// Optimises the knots of a path of Bezier curves so that it follows given points closely.
#pragma once

#include <span>
#include <vector>

#include "motionblur/paths/screen_path.h"

namespace postlens {

/// Largest distance of the path from the points at their times, px.
[[nodiscard]] double greatest_error_px(const ScreenPath& path, std::span<const PathPoint> points);

/// Finds positions, handles and times of the knots of a Bezier path such that its largest distance from the
/// points is small. `times_s`: initial times of the knots, 2 or more in increasing order; the first and last
/// are those of the points. Stops when the distance is at most `tolerance_px` or no longer falls. Distances
/// above the tolerance count by their fourth power, so that the largest ones dominate. Returns the best knots
/// found.
[[nodiscard]] std::vector<PathKnot> refine_path(std::span<const PathPoint> points,
                                                const std::vector<double>& times_s, double tolerance_px);

}  // namespace postlens
