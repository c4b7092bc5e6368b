#include "motionblur/paths/path_raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/memory.h"

namespace postlens {
namespace {

using glm::dvec2;

/// Largest accepted coordinate of a point of a motion path, in cells of the raster into which the path is
/// drawn. Up to this value, a double has a rounding error below a thousandth of a cell.
constexpr double farthest_cell = 1e13;

/// A straight piece of a motion path, with constant velocity.
struct Piece {
    double begin, end;  ///< times, as fractions of the exposure
    /// Positions of the ends, in cells of the raster into which the path is drawn. 1/2 is added to each
    /// coordinate. So cell i, which contains the displacements that round to i, covers the coordinates [i, i
    /// + 1).
    dvec2 from, to;
    double value_from = 1, value_to = 1;

    [[nodiscard]] double value_at(double share_of_piece) const {
        return value_from + share_of_piece * (value_to - value_from);
    }
};

/// The raster cells that a straight piece of a motion path crosses, along one axis (x or y). The piece goes
/// from the coordinate `from` to the coordinate `to`, in cells.
class Crossings {
  public:
    Crossings(double from, double to)
        : from_(from), way_(to - from), cell_(std::floor(from)), last_(std::floor(to)) {}

    [[nodiscard]] double cell() const { return cell_; }
    [[nodiscard]] double count() const { return std::abs(last_ - cell_); }
    /// Returns where the piece of the motion path leaves the current raster cell along this axis (x or y), as
    /// a fraction of the piece from 0 to 1. The result is infinity if the piece ends in this cell.
    [[nodiscard]] double next() const {
        if (cell_ == last_) return std::numeric_limits<double>::infinity();
        return std::clamp(((way_ > 0 ? cell_ + 1 : cell_) - from_) / way_, 0.0, 1.0);
    }
    void cross() { cell_ += way_ > 0 ? 1 : -1; }

  private:
    double from_, way_, cell_, last_;
};

/// Range of cells, initially empty.
struct Extent {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
    void add(double cell) {
        least = std::min(least, cell);
        greatest = std::max(greatest, cell);
    }
    [[nodiscard]] double length() const { return greatest - least + 1; }
};

/// Shortens a piece of a motion path to its part inside `window`, a rectangle of raster cells. The rectangle
/// is enlarged by half a cell on every side, because otherwise rounding errors could remove a visible part of
/// the piece. Returns false if no part of the piece is inside.
bool clip(Piece& piece, const CellWindow& window) {
    double enter = 0, leave = 1;
    const dvec2 way = piece.to - piece.from;
    const dvec2 low(window.x_begin - 0.5, window.y_begin - 0.5), high(window.x_end + 0.5, window.y_end + 0.5);
    for (int axis = 0; axis < 2; ++axis) {
        if (way[axis] == 0) {
            if (!(piece.from[axis] >= low[axis] && piece.from[axis] < high[axis])) return false;
            continue;
        }
        const double a = (low[axis] - piece.from[axis]) / way[axis];
        const double b = (high[axis] - piece.from[axis]) / way[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (!(enter < leave)) return false;
    const Piece whole = piece;
    const auto mix = [](auto a, auto b, double share) { return (1 - share) * a + share * b; };
    piece.begin = mix(whole.begin, whole.end, enter);
    piece.end = mix(whole.begin, whole.end, leave);
    piece.from = mix(whole.from, whole.to, enter);
    piece.to = mix(whole.from, whole.to, leave);
    piece.value_from = whole.value_at(enter);
    piece.value_to = whole.value_at(leave);
    // If a piece of the motion path had its ends far outside the raster before clipping, rounding errors can
    // move the clipped ends out of the clipping window. So they are clamped to positions at most one cell
    // outside this window.
    for (int axis = 0; axis < 2; ++axis) {
        piece.from[axis] = std::clamp(piece.from[axis], low[axis] - 1, high[axis] + 1);
        piece.to[axis] = std::clamp(piece.to[axis], low[axis] - 1, high[axis] + 1);
    }
    return true;
}

std::vector<Piece> pieces_of(std::span<const PathPoint> points, std::span<const double> values,
                             dvec2 origin_px, double open_s, double close_s, int cells_per_px) {
    const auto place = [&](const PathPoint& p) {
        return static_cast<double>(cells_per_px) * (p.at_px - origin_px) + 0.5;
    };
    const auto share = [&](double time_s) {
        return std::clamp((time_s - open_s) / (close_s - open_s), 0.0, 1.0);
    };
    const auto value = [&](std::size_t i) { return values.empty() ? 1.0 : values[i]; };
    std::vector<Piece> out;
    out.reserve(points.size() + 1);
    const auto stand = [&](double begin, double end, std::size_t i) {
        out.push_back({begin, end, place(points[i]), place(points[i]), value(i), value(i)});
    };
    const PathPoint &first = points.front(), &last = points.back();
    if (open_s == close_s) {
        // The exposure is a single instant, so the object does not move during it, and is drawn at one point
        // of its motion path. This is the first point at or after this instant. If there is none, it is the
        // last point.
        const auto at = std::find_if(points.begin(), points.end() - 1,
                                     [&](const PathPoint& p) { return p.time_s >= open_s; });
        stand(0, 1, static_cast<std::size_t>(at - points.begin()));
        return out;
    }
    if (share(first.time_s) > 0) stand(0, share(first.time_s), 0);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const PathPoint &a = points[i], &b = points[i + 1];
        if (!(b.time_s > open_s && a.time_s < close_s && b.time_s > a.time_s)) continue;
        const auto along = [&](double time_s) {
            return std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
        };
        const double begin = along(std::max(a.time_s, open_s)), end = along(std::min(b.time_s, close_s));
        const auto at = [&](double s) { return (1 - s) * place(a) + s * place(b); };
        Piece piece{share(a.time_s), share(b.time_s), at(begin), at(end), value(i), value(i + 1)};
        const double value_begin = piece.value_at(begin);
        piece.value_to = piece.value_at(end);
        piece.value_from = value_begin;
        out.push_back(piece);
    }
    if (share(last.time_s) < 1) stand(share(last.time_s), 1, points.size() - 1);
    return out;
}

void check(std::span<const PathPoint> points, dvec2 origin_px, double open_s, double close_s,
           int cells_per_px) {
    if (!(open_s <= close_s) || !std::isfinite(close_s - open_s)) {
        fail(ExitCode::wrong_arguments, "shutter: close (got {} s) must not come before open (got {} s)",
             close_s, open_s);
    }
    if (points.empty()) fail(ExitCode::wrong_arguments, "path: no points (expected 1 or more)");
    if (cells_per_px < 1) {
        fail(ExitCode::wrong_arguments, "path: cells per pixel out of range (got {}; expected 1 or more)",
             cells_per_px);
    }
    for (const PathPoint& p : points) {
        const dvec2 cells = static_cast<double>(cells_per_px) * (p.at_px - origin_px);
        // The comparisons are false for NaN, so that NaN is rejected.
        const bool near = std::abs(cells.x) <= farthest_cell && std::abs(cells.y) <= farthest_cell;
        if (!near || !std::isfinite(p.time_s)) {
            fail(ExitCode::wrong_arguments,
                 "path: place out of range (got {} px, {} px at {} s; expected at most {:g} px away)",
                 p.at_px.x, p.at_px.y, p.time_s, farthest_cell / cells_per_px);
        }
    }
}

/// Rejects paths that would need too much memory or time.
void require_reasonable(const Extent& x, const Extent& y, double crossings, int cells_per_px) {
    const double longest = std::max(x.length(), y.length());
    const double farthest = std::max({-x.least, x.greatest, -y.least, y.greatest});
    if (longest > most_path_cells || farthest > 0.5 * std::numeric_limits<int>::max()) {
        fail(ExitCode::wrong_arguments, "path: too long (spans {:g} px, {:g} px away; expected at most {:g})",
             longest / cells_per_px, farthest / cells_per_px, most_path_cells / cells_per_px);
    }
    if (crossings > most_path_crossings) {
        fail(ExitCode::wrong_arguments,
             "path: too long a way (crosses {:g} borders of cells; expected at most {:g})", crossings,
             most_path_crossings);
    }
    require_memory(static_cast<std::uint64_t>(x.length() * y.length() * sizeof(double)),
                   fmt::format("path: a raster of {:g} x {:g} cells", x.length(), y.length()));
}

}  // namespace

PathRaster draw_path(std::span<const PathPoint> points, glm::dvec2 origin_px, double open_s, double close_s,
                     const ShutterCurve& curve, int cells_per_px, const std::optional<CellWindow>& keep,
                     std::span<const double> values) {
    check(points, origin_px, open_s, close_s, cells_per_px);
    assert(values.empty() || values.size() == points.size());
    std::vector<Piece> pieces = pieces_of(points, values, origin_px, open_s, close_s, cells_per_px);
    if (keep) std::erase_if(pieces, [&](Piece& p) { return !clip(p, *keep); });
    PathRaster out;
    out.cells_per_px = cells_per_px;
    Extent x, y;
    double crossings = 0;
    for (const Piece& p : pieces) {
        for (const dvec2& at : {p.from, p.to}) {
            x.add(std::floor(at.x));
            y.add(std::floor(at.y));
        }
        crossings += Crossings(p.from.x, p.to.x).count() + Crossings(p.from.y, p.to.y).count();
    }
    if (keep && !pieces.empty()) {
        x = {std::max(x.least, 1.0 * keep->x_begin), std::min(x.greatest, keep->x_end - 1.0)};
        y = {std::max(y.least, 1.0 * keep->y_begin), std::min(y.greatest, keep->y_end - 1.0)};
    }
    if (pieces.empty() || x.least > x.greatest || y.least > y.greatest) return out;
    require_reasonable(x, y, crossings, cells_per_px);
    out.x_begin = static_cast<int>(x.least);
    out.y_begin = static_cast<int>(y.least);
    out.width = static_cast<int>(x.length());
    out.height = static_cast<int>(y.length());
    out.weight.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), 0.0);

    const auto add = [&](double cell_x, double cell_y, double light) {
        const double column = cell_x - x.least, row = cell_y - y.least;
        if (!(column >= 0 && column < out.width && row >= 0 && row < out.height)) return;
        out.weight[static_cast<std::size_t>(row) * static_cast<std::size_t>(out.width) +
                   static_cast<std::size_t>(column)] += light;
    };
    for (const Piece& p : pieces) {
        Crossings along_x(p.from.x, p.to.x), along_y(p.from.y, p.to.y);
        double light_before = curve.light(p.begin), before = 0;
        for (;;) {
            const double at_x = along_x.next(), at_y = along_y.next(), at = std::min(at_x, at_y);
            const double light = at > 1 ? curve.light(p.end) : curve.light(p.begin + at * (p.end - p.begin));
            const double value = p.value_at(0.5 * (before + std::min(at, 1.0)));
            add(along_x.cell(), along_y.cell(), value * std::max(0.0, light - light_before));
            if (at > 1) break;
            light_before = std::max(light, light_before);
            before = at;
            if (at_x <= at_y) along_x.cross();
            if (at_y <= at_x) along_y.cross();
        }
    }
    return out;
}

}  // namespace postlens
