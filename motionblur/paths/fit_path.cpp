#include "motionblur/paths/fit_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/error.h"
#include "motionblur/paths/refine_path.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec4;

using Points = std::span<const PathPoint>;

void check(Points points, double tolerance_px) {
    if (!(tolerance_px > 0) || !std::isfinite(tolerance_px)) {
        fail(ExitCode::wrong_arguments,
             "--fit-paths: out of range (got {} px; expected a finite number above 0)", tolerance_px);
    }
    if (points.empty() || points.size() > most_knots) {
        fail(ExitCode::wrong_arguments,
             "--fit-paths: number of points out of range (got {}; expected 1 to {})", points.size(),
             most_knots);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const PathPoint& p = points[i];
        const bool is_near = std::abs(p.at_px.x) <= largest_path_coordinate_px &&
                             std::abs(p.at_px.y) <= largest_path_coordinate_px &&
                             std::abs(p.time_s) <= largest_path_time_s;
        if (!is_near || (i > 0 && !(p.time_s > points[i - 1].time_s))) {
            fail(ExitCode::wrong_arguments,
                 "--fit-paths: point {} is out of range or order (got {} px, {} px at {} s; expected growing "
                 "times)",
                 i + 1, p.at_px.x, p.at_px.y, p.time_s);
        }
    }
}

/// A cubic Bezier curve from point `first` to point `last`. Its parameter u is time, scaled to 0..1.
struct Cubic {
    std::array<dvec2, 4> control{};
    [[nodiscard]] dvec2 at(double u) const {
        const double v = 1 - u;
        return v * v * v * control[0] + 3 * v * v * u * control[1] + 3 * v * u * u * control[2] +
               u * u * u * control[3];
    }
};

/// Fits a cubic to the points [first, last] by least squares, beginning at `start` if given. Returns nothing
/// if its error exceeds the tolerance.
std::optional<Cubic> fit_cubic(Points points, std::size_t first, std::size_t last,
                               const std::optional<dvec2>& start, double tolerance_px) {
    constexpr std::size_t most_used = 512;  // more than enough for a cubic; the error is tested at all points
    const double begin_s = points[first].time_s, span_s = points[last].time_s - begin_s;
    const auto share = [&](std::size_t i) { return (points[i].time_s - begin_s) / span_s; };
    // The initial curve is a straight line in constant motion, from the curve's start to the last point. The
    // fit computes how far to move its control points. If the points do not determine this, regularisation
    // leaves the control points almost unchanged.
    Cubic out;
    const dvec2 from = start.value_or(points[first].at_px), to = points[last].at_px;
    for (int k = 0; k < 4; ++k) out.control[static_cast<std::size_t>(k)] = from + (to - from) * (k / 3.0);
    const std::size_t count = std::min(last - first + 1, most_used);
    glm::dmat4 normal(1e-9);  // regularisation, which is small compared with entries of about count / 10
    dvec4 right_x(0), right_y(0);
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t i = first + n * (last - first) / (count - 1);
        const double u = share(i), v = 1 - u;
        dvec4 basis(v * v * v, 3 * v * v * u, 3 * v * u * u, u * u * u);
        if (start) basis[0] = 0;
        const dvec2 off = points[i].at_px - out.at(u);
        normal += glm::outerProduct(basis, basis);
        right_x += off.x * basis;
        right_y += off.y * basis;
    }
    const glm::dmat4 inverse = glm::inverse(normal);
    const dvec4 x = inverse * right_x, y = inverse * right_y;
    for (int k = start ? 1 : 0; k < 4; ++k) out.control[static_cast<std::size_t>(k)] += dvec2(x[k], y[k]);
    // A cubic that was fitted to only two points must end exactly at the second point. The fit reaches this
    // point only up to a rounding error, so the last control point is set to it.
    if (last == first + 1) out.control[3] = points[last].at_px;
    for (std::size_t i = first; i <= last; ++i)
        if (!(glm::distance(out.at(share(i)), points[i].at_px) <= tolerance_px)) return std::nullopt;
    return out;
}

struct Segment {
    std::size_t first = 0, last = 0;
    Cubic cubic;
};

/// Divides a motion path, given as points at known times, into segments. In each segment, a cubic curve
/// follows the points within the tolerance, and the segment has as many points as this allows. If `joined`,
/// each curve begins where the previous curve ends. Stops after `most` segments.
std::vector<Segment> lay_segments(Points points, double tolerance_px, bool joined, std::size_t most) {
    std::vector<Segment> out;
    for (std::size_t first = 0; first + 1 < points.size() && out.size() < most;) {
        std::optional<dvec2> start;
        if (joined && !out.empty()) start = out.back().cubic.control[3];
        const auto attempt = [&](std::size_t last) {
            return fit_cubic(points, first, last, start, tolerance_px);
        };
        Segment best{first, first + 1, {}};
        std::size_t too_far = points.size();
        for (std::size_t length = 1;; length *= 2) {
            const std::size_t last = std::min(first + length, points.size() - 1);
            const auto cubic = attempt(last);
            if (cubic) best = {first, last, *cubic};
            if (!cubic && length >= 4) {  // shorter segments may fail only because of their fixed start
                too_far = last;
                break;
            }
            if (last == points.size() - 1) break;
        }
        while (too_far - best.last > 1 && too_far < points.size()) {
            const std::size_t middle = best.last + (too_far - best.last) / 2;
            if (const auto cubic = attempt(middle)) {
                best = {first, middle, *cubic};
            } else {
                too_far = middle;
            }
        }
        if (best.last == first + 1) {
            const dvec2 from = start.value_or(points[first].at_px), to = points[best.last].at_px;
            best.cubic.control = {from, from + (to - from) / 3.0, to - (to - from) / 3.0, to};
        }
        out.push_back(best);
        first = best.last;
    }
    return out;
}

std::vector<PathKnot> knots_of(Points points, const std::vector<Segment>& segments) {
    std::vector<PathKnot> knots{{points.front().time_s, segments.front().cubic.control[0], {}, {}}};
    for (const Segment& s : segments) {
        const auto& c = s.cubic.control;
        knots.back().out_px = c[1] - c[0];
        knots.push_back({points[s.last].time_s, c[3], c[2] - c[3], {}});
    }
    return knots;
}

/// Returns the times of the knots of a spline with `count` segments. `segments` come from an earlier fit, in
/// which segments are short where the motion changes quickly. So each segment of the new spline extends over
/// the same number of earlier segments.
std::vector<double> spread_times(Points points, const std::vector<Segment>& segments, std::size_t count) {
    std::vector<double> times{points.front().time_s};
    for (std::size_t i = 1; i < count; ++i) {
        const double place = static_cast<double>(i * segments.size()) / static_cast<double>(count);
        const Segment& s = segments[static_cast<std::size_t>(place)];
        const double begin_s = points[s.first].time_s, end_s = points[s.last].time_s;
        times.push_back(begin_s + (place - std::floor(place)) * (end_s - begin_s));
    }
    times.push_back(points.back().time_s);
    return times;
}

/// Returns the times of the knots of a motion path, without short segments at kinks. At a kink, where the
/// velocity changes abruptly, the fit made a short segment between two long ones. Its start and end knots are
/// replaced by a single knot, between its first two points.
std::vector<double> times_without_kinks(Points points, const std::vector<Segment>& segments) {
    constexpr std::size_t short_pieces = 3, long_pieces = 8;
    const auto pieces = [&](std::size_t i) { return segments[i].last - segments[i].first; };
    std::vector<double> times{points.front().time_s};
    for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
        const Segment& s = segments[i];
        const bool is_kink = i > 0 && pieces(i) <= short_pieces && pieces(i - 1) >= long_pieces &&
                             pieces(i + 1) >= long_pieces;
        if (is_kink) {
            times.back() = 0.5 * (points[s.first].time_s + points[s.first + 1].time_s);
        } else {
            times.push_back(points[s.last].time_s);
        }
    }
    times.push_back(points.back().time_s);
    return times;
}

PathFit polyline_of(Points points) {
    std::vector<PathKnot> knots;
    knots.reserve(points.size());
    for (const PathPoint& p : points) knots.push_back({p.time_s, p.at_px, {}, {}});
    return {ScreenPath(PathKind::polyline, std::move(knots), "--fit-paths"), 0};
}

std::optional<PathFit> still(Points points, double tolerance_px) {
    dvec2 low = points.front().at_px, high = low;
    for (const PathPoint& p : points) {
        low = glm::min(low, p.at_px);
        high = glm::max(high, p.at_px);
    }
    PathFit out{
        ScreenPath(PathKind::polyline, {{points.front().time_s, 0.5 * (low + high), {}, {}}}, "--fit-paths"),
        0};
    out.error_px = greatest_error_px(out.path, points);
    if (out.error_px <= tolerance_px) return out;
    return std::nullopt;
}

}  // namespace

PathFit fit_path(Points points, double tolerance_px) {
    check(points, tolerance_px);
    if (auto fit = still(points, tolerance_px)) return *fit;
    const auto fit_of = [&](std::vector<PathKnot> knots) {
        PathFit fit{ScreenPath(PathKind::bezier, std::move(knots), "--fit-paths"), 0};
        fit.error_px = greatest_error_px(fit.path, points);
        return fit;
    };
    const std::vector<Segment> segments = lay_segments(points, tolerance_px, true, points.size());
    PathFit best =
        segments.size() + 1 < points.size() ? fit_of(knots_of(points, segments)) : polyline_of(points);
    if (best.error_px > tolerance_px)
        best = polyline_of(points);  // a spline's rounding error can exceed a very small tolerance
    if (segments.size() > most_refined_segments) return best;
    // Estimates the smallest number of segments that a spline needs to follow the points. For this, it counts
    // the segments of a fit with fewer constraints: the cubic of a segment need not begin where the previous
    // cubic ends, and the tolerance is twice as large.
    std::size_t fewest =
        std::max<std::size_t>(1, lay_segments(points, 2 * tolerance_px, false, points.size()).size());
    std::size_t enough = best.path.knots() - 1;
    const auto attempt = [&](const std::vector<double>& times) {
        PathFit fit = fit_of(refine_path(points, times, tolerance_px));
        if (!(fit.error_px <= tolerance_px) || fit.path.knots() >= best.path.knots()) return false;
        best = std::move(fit);
        enough = times.size() - 1;
        return true;
    };
    const std::vector<double> times = times_without_kinks(points, segments);
    if (times.size() - 1 < enough) attempt(times);
    while (fewest < enough) {
        const std::size_t middle = fewest + (enough - fewest) / 2;
        if (!attempt(spread_times(points, segments, middle))) fewest = middle + 1;
    }
    return best;
}

}  // namespace postlens
