// Knots moved until a path of Bezier curves follows points as well as so many knots can.
#pragma once

#include <span>
#include <vector>

#include "motionblur/screen_path.h"

namespace postlens {

/// The greatest distance of the path from the points, px, at equal times.
[[nodiscard]] double greatest_error_px(const ScreenPath& path, std::span<const PathPoint> points);

/// Moves places, handles and times of knots of a Bezier path, which stands at `times_s` (2 or more, the first
/// and last those of the points, in growing order) at first: for a small greatest distance, until it is
/// `tolerance_px` or less or nothing is gained. Distances count by their fourth power where they are above
/// the tolerance, so that the largest lead. Returns the best that was seen.
[[nodiscard]] std::vector<PathKnot> refine_path(std::span<const PathPoint> points,
                                                const std::vector<double>& times_s, double tolerance_px);

}  // namespace postlens
