// A moving object's position on the raster as a function of time.
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
/// Largest absolute values in a motion path: coordinates of knots and Bezier handles, in px, and times, in s.
inline constexpr double largest_path_coordinate_px = 1e12;
inline constexpr double largest_path_time_s = 1e9;
/// Approximate limit of the number of points that `flatten` returns. `flatten` approximates a motion path by
/// points with linear interpolation between them. If its tolerance requires more points than this limit, it
/// stops, and the error is then larger than the tolerance.
inline constexpr std::size_t most_path_points = 1'000'000;

/// The motion between two knots.
/// - polyline: constant velocity.
/// - catmull_rom: a cubic in time. The velocity at a knot is that of the parabola through the knot and its
///   neighbours. At an end of the path, it is that of the line to the only neighbour.
/// - bezier: a cubic Bezier curve in time. Velocity is constant if each handle reaches a third of the way to
///   the neighbouring knot.
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

/// The motion of a point in the image: its position on the raster, in px, as a function of time (r'(t) in
/// [potmesil1983]). The motion is given by knots, which are positions at certain times. The position is
/// constant before the first knot and after the last one.
class ScreenPath {
  public:
    /// A path that stays at (0, 0).
    ScreenPath();
    /// Throws Error(invalid_input), with a message that begins with `source`, unless there are 1 to
    /// `most_knots` knots at increasing times. Numbers must be finite and not too large.
    ScreenPath(PathKind kind, std::vector<PathKnot> knots, const std::string& source);

    [[nodiscard]] glm::dvec2 at(double time_s) const;
    /// Approximates the path from open_s to close_s by points. Linear interpolation in time between them
    /// keeps shape and speed, with an error of at most `tolerance_px`.
    [[nodiscard]] std::vector<PathPoint> flatten(double open_s, double close_s,
                                                 double tolerance_px = 0.01) const;
    [[nodiscard]] std::size_t knots() const { return knots_.size(); }
    /// Returns the knots of the path with their Bezier handles. For a catmull_rom path, these are the handles
    /// of the equivalent Bezier curve. For a polyline, they are 0.
    [[nodiscard]] std::span<const PathKnot> knot_list() const { return knots_; }
    [[nodiscard]] PathKind kind() const { return kind_; }

  private:
    PathKind kind_ = PathKind::polyline;
    std::vector<PathKnot> knots_;
};

/// Approximates the position `at`, a function of time, by at least 16 pieces of constant velocity. Each is
/// halved, at most 20 times, until its error at five instants is below `tolerance_px`. `breaks_s` contains,
/// in increasing order, the instants at which the velocity may change abruptly. `at` must return finite
/// positions.
[[nodiscard]] std::vector<PathPoint> flatten(const std::function<glm::dvec2(double)>& at,
                                             std::span<const double> breaks_s, double open_s, double close_s,
                                             double tolerance_px = 0.01);

}  // namespace postlens
