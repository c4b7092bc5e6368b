// Where a moving thing is on the raster at each instant, and such motions as pieces of constant velocity.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace postlens {

/// The most knots that one path may have.
inline constexpr std::size_t most_knots = 100'000;
/// Coordinates of knots and handles, px, and times, s, may be this large.
inline constexpr double largest_path_coordinate_px = 1e12;
inline constexpr double largest_path_time_s = 1e9;
/// `flatten` gives about as many points at most: where that does not suffice, its tolerance is not kept.
inline constexpr std::size_t most_path_points = 1'000'000;

/// What a path does between two knots:
/// - polyline: constant velocity;
/// - catmull_rom: a cubic in time whose velocity at a knot is that of the parabola through it and its
///   neighbours, at the first and last knot that of the straight line to the next, for knots at any times;
/// - bezier: time is linear in the curve's parameter, and the place is the cubic Bezier curve of at, at +
/// out,
///   next at + in, next at. So handles of a third of the way make constant velocity, and handles that are
///   longer make it start and arrive faster.
enum class PathKind { polyline, catmull_rom, bezier };

struct PathKnot {
    double time_s = 0;
    glm::dvec2 at_px{0};
    glm::dvec2 in_px{0}, out_px{0};  ///< bezier alone: handles, relative to at_px
};

struct PathPoint {
    double time_s = 0;
    glm::dvec2 at_px{0};
};

/// r'(t) of [potmesil1983]: a place on the raster, px, for every instant. Held still before the first and
/// after the last knot.
class ScreenPath {
  public:
    /// Still at 0.
    ScreenPath();
    /// Throws Error(invalid_input) that begins with `source` where there is no knot or more than
    /// `most_knots`, where times do not grow, and where a number is not finite or too large.
    ScreenPath(PathKind kind, std::vector<PathKnot> knots, const std::string& source);

    [[nodiscard]] glm::dvec2 at(double time_s) const;
    /// Points between which the place is linear in time within `tolerance_px` (more than 0): both where the
    /// path goes and how fast. The first is at open_s, the last at close_s (one point where they are equal).
    [[nodiscard]] std::vector<PathPoint> flatten(double open_s, double close_s,
                                                 double tolerance_px = 0.01) const;
    [[nodiscard]] std::size_t knots() const { return knots_.size(); }
    /// As given, but for the handles: those of catmull_rom are what makes it a Bezier curve, those of a
    /// polyline are 0.
    [[nodiscard]] std::span<const PathKnot> knot_list() const { return knots_; }
    [[nodiscard]] PathKind kind() const { return kind_; }

  private:
    PathKind kind_ = PathKind::polyline;
    std::vector<PathKnot> knots_;
};

/// The same for any function of time, e.g. the projection of a rigid motion. `breaks_s` are instants, in
/// growing order, where its velocity may jump. Pieces are halved until the function agrees with them at five
/// uneven instants, at most 20 times; at least 16 pieces are tried, and two between neighbouring breaks.
/// `at` must give finite places. Deterministic.
[[nodiscard]] std::vector<PathPoint> flatten(const std::function<glm::dvec2(double)>& at,
                                             std::span<const double> breaks_s, double open_s, double close_s,
                                             double tolerance_px = 0.01);

}  // namespace postlens
