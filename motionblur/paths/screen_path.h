// The position of a moving object on the raster as a function of time, and its approximation by pieces of
// constant velocity.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace postlens {

/// Largest number of knots of a path.
inline constexpr std::size_t most_knots = 100'000;
/// Largest absolute values in a path: coordinates of knots and handles, in px, and times of knots, in
/// seconds.
inline constexpr double largest_path_coordinate_px = 1e12;
inline constexpr double largest_path_time_s = 1e9;
/// Approximate limit of the number of points that `flatten` returns. If the tolerance needs more points, the
/// error exceeds the tolerance.
inline constexpr std::size_t most_path_points = 1'000'000;

/// The motion between two knots.
/// - polyline: constant velocity.
/// - catmull_rom: a cubic in time. Its velocity at a knot is that of the parabola through the knot and its
///   two neighbours. At the first and last knot, it is that of the straight line to the only neighbour. The
///   times of knots may be unevenly spaced.
/// - bezier: a cubic Bezier curve. Its control points are at_px and at_px + out_px of the first knot, and
///   at_px + in_px and at_px of the next knot. The curve's parameter is linear in time. Handles of a third of
///   the distance result in constant velocity. Longer handles result in higher velocities at the knots.
enum class PathKind { polyline, catmull_rom, bezier };

struct PathKnot {
    double time_s = 0;
    glm::dvec2 at_px{0};
    glm::dvec2 in_px{0}, out_px{0};  ///< handles relative to at_px; only used by bezier
};

struct PathPoint {
    double time_s = 0;
    glm::dvec2 at_px{0};
};

/// A position on the raster, in px, for every instant: r'(t) in [potmesil1983]. The position is constant
/// before the first and after the last knot.
class ScreenPath {
  public:
    /// A path that stays at (0, 0).
    ScreenPath();
    /// Throws Error(invalid_input) if there are no knots or more than `most_knots`, if times do not increase,
    /// or if numbers are not finite or too large. The message begins with `source`.
    ScreenPath(PathKind kind, std::vector<PathKnot> knots, const std::string& source);

    [[nodiscard]] glm::dvec2 at(double time_s) const;
    /// Returns points of the path. Linear interpolation in time between them has an error of at most
    /// `tolerance_px`, which must be above 0. This preserves both the shape and the speed of the path. The
    /// first point is at open_s and the last at close_s. If these are equal, there is only one point.
    [[nodiscard]] std::vector<PathPoint> flatten(double open_s, double close_s,
                                                 double tolerance_px = 0.01) const;
    [[nodiscard]] std::size_t knots() const { return knots_.size(); }
    /// Returns the given knots. For catmull_rom, their handles are those of the equivalent Bezier curve. For
    /// a polyline, their handles are 0.
    [[nodiscard]] std::span<const PathKnot> knot_list() const { return knots_; }
    [[nodiscard]] PathKind kind() const { return kind_; }

  private:
    PathKind kind_ = PathKind::polyline;
    std::vector<PathKnot> knots_;
};

/// Approximates a function of time, such as the projection of a rigid motion, by pieces of constant velocity.
/// `breaks_s` contains, in increasing order, the instants at which the velocity may change abruptly. There
/// are at least 16 pieces, and at least two between neighbouring breaks.
///
/// Each piece is halved, at most 20 times, until it agrees with the function within the tolerance at five
/// unevenly spaced instants. `at` must return finite positions. The result is deterministic.
[[nodiscard]] std::vector<PathPoint> flatten(const std::function<glm::dvec2(double)>& at,
                                             std::span<const double> breaks_s, double open_s, double close_s,
                                             double tolerance_px = 0.01);

}  // namespace postlens
