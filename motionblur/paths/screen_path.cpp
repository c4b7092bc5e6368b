#include "motionblur/paths/screen_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace postlens {
namespace {

using glm::dvec2;

bool within(double value, double largest) {
    return std::abs(value) <= largest;  // false for NaN
}

bool within(const dvec2& value) {
    return within(value.x, largest_path_coordinate_px) && within(value.y, largest_path_coordinate_px);
}

void check(const std::vector<PathKnot>& knots, const std::string& source) {
    if (knots.empty()) fail(ExitCode::invalid_input, "{}: no knots (expected 1 or more)", source);
    if (knots.size() > most_knots) {
        fail(ExitCode::invalid_input, "{}: too many knots (got {}; expected at most {})", source,
             knots.size(), most_knots);
    }
    for (std::size_t i = 0; i < knots.size(); ++i) {
        const PathKnot& k = knots[i];
        if (!within(k.time_s, largest_path_time_s)) {
            fail(ExitCode::invalid_input, "{}: time out of range (got {} s at knot {}; expected {} to {})",
                 source, k.time_s, i + 1, -largest_path_time_s, largest_path_time_s);
        }
        if (i > 0 && !(k.time_s > knots[i - 1].time_s)) {
            fail(ExitCode::invalid_input, "{}: times do not grow (got {} s after {} s at knot {})", source,
                 k.time_s, knots[i - 1].time_s, i + 1);
        }
        for (const dvec2& p : {k.at_px, k.in_px, k.out_px}) {
            if (within(p)) continue;
            fail(ExitCode::invalid_input,
                 "{}: place or handle out of range (got {}, {} at knot {}; expected {} to {})", source, p.x,
                 p.y, i + 1, -largest_path_coordinate_px, largest_path_coordinate_px);
        }
    }
}

// Converts a Catmull-Rom spline to the equivalent Bezier curve, by computing the handles of each knot. A
// handle is a vector from the knot to a control point of the curve, in px. It is the velocity at the knot
// times a third of the time to the neighbouring knot.
void lay_catmull_rom_handles(std::vector<PathKnot>& knots) {
    const std::size_t last = knots.size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
        const auto velocity_to_next = [&](std::size_t k) {
            return (knots[k + 1].at_px - knots[k].at_px) / (knots[k + 1].time_s - knots[k].time_s);
        };
        PathKnot& k = knots[i];
        const double before_s = i > 0 ? k.time_s - knots[i - 1].time_s : 0;
        const double after_s = i < last ? knots[i + 1].time_s - k.time_s : 0;
        dvec2 velocity(0);
        if (i > 0 && i < last) {
            velocity =
                (after_s * velocity_to_next(i - 1) + before_s * velocity_to_next(i)) / (before_s + after_s);
        } else if (last > 0) {
            velocity = velocity_to_next(i == 0 ? 0 : last - 1);
        }
        k.in_px = -velocity * (before_s / 3);
        k.out_px = velocity * (after_s / 3);
    }
}

void require_order(double open_s, double close_s, double tolerance_px) {
    if (!(open_s <= close_s) || !std::isfinite(open_s) || !std::isfinite(close_s)) {
        fail(ExitCode::wrong_arguments, "shutter: close (got {} s) must not come before open (got {} s)",
             close_s, open_s);
    }
    if (!(tolerance_px > 0)) {
        fail(ExitCode::wrong_arguments, "path tolerance: out of range (got {} px; expected more than 0)",
             tolerance_px);
    }
}

// The distance between a curved motion path and its linear approximation is measured at these fractions of a
// linear piece's duration. They are not symmetric about 0.5, because a motion that turns back halfway passes
// the same positions in both halves.
constexpr std::array<double, 5> test_shares{0.1271, 0.3094, 0.5, 0.7071, 0.8819};
// Fraction of the tolerance that the measured error of a linear piece may reach. The error is measured only
// at a few of the piece's instants, `test_shares`, and can be larger between them.
constexpr double tested_tolerance = 0.75;

}  // namespace

ScreenPath::ScreenPath() : knots_(1) {}

ScreenPath::ScreenPath(PathKind kind, std::vector<PathKnot> knots, const std::string& source)
    : kind_(kind), knots_(std::move(knots)) {
    check(knots_, source);
    if (kind_ == PathKind::catmull_rom) lay_catmull_rom_handles(knots_);
    if (kind_ == PathKind::polyline) {
        for (PathKnot& k : knots_) k.in_px = k.out_px = dvec2(0);
    }
}

glm::dvec2 ScreenPath::at(double time_s) const {
    const auto after = std::upper_bound(knots_.begin(), knots_.end(), time_s,
                                        [](double t, const PathKnot& k) { return t < k.time_s; });
    if (after == knots_.begin()) return knots_.front().at_px;
    if (after == knots_.end()) return knots_.back().at_px;
    const PathKnot &a = *(after - 1), &b = *after;
    const double u = (time_s - a.time_s) / (b.time_s - a.time_s), v = 1 - u;
    if (kind_ == PathKind::polyline) return v * a.at_px + u * b.at_px;
    return v * v * v * a.at_px + 3 * v * v * u * (a.at_px + a.out_px) + 3 * v * u * u * (b.at_px + b.in_px) +
           u * u * u * b.at_px;
}

std::vector<PathPoint> ScreenPath::flatten(double open_s, double close_s, double tolerance_px) const {
    require_order(open_s, close_s, tolerance_px);
    std::vector<PathPoint> out{{open_s, at(open_s)}};
    if (open_s == close_s) return out;
    // A chord over a time step h deviates from the curve by at most c h^2 / 8, where c is the largest second
    // derivative. The second derivative of a cubic is linear, so its largest value is at one of the ends.
    const auto acceleration = [&](std::size_t i) {
        const PathKnot &a = knots_[i], &b = knots_[i + 1];
        const dvec2 p0 = a.at_px, p1 = a.at_px + a.out_px, p2 = b.at_px + b.in_px, p3 = b.at_px;
        return 6 * std::max(glm::length(p0 - 2.0 * p1 + p2), glm::length(p1 - 2.0 * p2 + p3));
    };
    const auto begin_of = [&](std::size_t i) { return std::max(knots_[i].time_s, open_s); };
    const auto end_of = [&](std::size_t i) { return std::min(knots_[i + 1].time_s, close_s); };
    const auto pieces_of = [&](std::size_t i) {
        if (kind_ == PathKind::polyline) return 1.0;
        const double h = (end_of(i) - begin_of(i)) / (knots_[i + 1].time_s - knots_[i].time_s);
        return std::max(1.0, std::ceil(h * std::sqrt(acceleration(i) / (8 * tolerance_px))));
    };
    double wanted = 0;
    for (std::size_t i = 0; i + 1 < knots_.size(); ++i)
        if (begin_of(i) < end_of(i)) wanted += pieces_of(i);
    const double thinning = std::min(1.0, static_cast<double>(most_path_points) / wanted);
    for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
        const double begin_s = begin_of(i), end_s = end_of(i);
        if (!(begin_s < end_s)) continue;
        if (out.back().time_s < begin_s) out.push_back({begin_s, at(begin_s)});
        const auto pieces = static_cast<int>(std::max(1.0, std::floor(thinning * pieces_of(i))));
        for (int p = 1; p <= pieces; ++p) {
            const double time_s = p == pieces ? end_s : begin_s + (end_s - begin_s) * p / pieces;
            // Rounding can make successive instants equal. Only one of them becomes a point, because times
            // must increase.
            if (time_s > out.back().time_s) out.push_back({time_s, at(time_s)});
        }
    }
    if (out.back().time_s < close_s) out.push_back({close_s, at(close_s)});
    return out;
}

std::vector<PathPoint> flatten(const std::function<glm::dvec2(double)>& at, std::span<const double> breaks_s,
                               double open_s, double close_s, double tolerance_px) {
    require_order(open_s, close_s, tolerance_px);
    constexpr int fewest_pieces = 16, most_halvings = 20;
    struct Piece {
        PathPoint begin;
        bool final = false;
    };
    const auto point = [&](double time_s) { return PathPoint{time_s, at(time_s)}; };
    std::vector<Piece> pieces;
    const PathPoint last = point(close_s);
    const auto add_stretch = [&](double begin_s, double end_s) {
        const double share = (end_s - begin_s) / (close_s - open_s);
        const int count = std::max(2, static_cast<int>(std::ceil(share * fewest_pieces)));
        for (int p = 0; p < count; ++p) {
            const double time_s = begin_s + (end_s - begin_s) * p / count;
            if (pieces.empty() || time_s > pieces.back().begin.time_s) pieces.push_back({point(time_s)});
        }
    };
    double begin_s = open_s;
    for (const double break_s : breaks_s) {
        if (!(break_s > begin_s && break_s < close_s)) continue;
        add_stretch(begin_s, break_s);
        begin_s = break_s;
    }
    if (begin_s < close_s) add_stretch(begin_s, close_s);

    const auto is_straight = [&](const PathPoint& a, const PathPoint& b) {
        return std::none_of(test_shares.begin(), test_shares.end(), [&](double s) {
            const dvec2 on_chord = (1 - s) * a.at_px + s * b.at_px;
            return glm::distance(at(a.time_s + s * (b.time_s - a.time_s)), on_chord) >
                   tested_tolerance * tolerance_px;
        });
    };
    // In each round, every piece of the path that is not nearly straight is halved once. So if
    // `most_path_points` ends this early, the error increases in all these pieces, and not only in those at
    // the end of the path.
    for (int halving = 0; halving < most_halvings && pieces.size() < most_path_points; ++halving) {
        std::vector<Piece> next;
        next.reserve(2 * pieces.size());
        bool any = false;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const PathPoint& a = pieces[i].begin;
            const PathPoint& b = i + 1 < pieces.size() ? pieces[i + 1].begin : last;
            const double middle_s = a.time_s + 0.5 * (b.time_s - a.time_s);
            const bool final =
                pieces[i].final || !(middle_s > a.time_s && middle_s < b.time_s) || is_straight(a, b);
            next.push_back({a, final});
            if (final) continue;
            next.push_back({point(middle_s)});
            any = true;
        }
        pieces = std::move(next);
        if (!any) break;
    }
    std::vector<PathPoint> out;
    out.reserve(pieces.size() + 1);
    for (const Piece& piece : pieces) out.push_back(piece.begin);
    if (out.empty() || out.back().time_s < last.time_s) out.push_back(last);
    return out;
}

}  // namespace postlens
