#include "tracer/recording/small_things.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "scene/object_pose.h"
#include "scene/shape_bounds.h"

namespace postlens {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr int tile_px = 16;
// Number of pieces into which a long narrow object is divided along its axis. Each piece is treated as if it
// had one width and one depth, although the object's width and depth may vary along its length.
constexpr int pieces = 16;
// Largest number of times that a piece of a cone is halved. To find narrow objects in the image, long ones
// are divided into pieces along their axis, and each piece is treated as if its width were constant. A cone
// tapers. So a piece of a cone is halved as long as one of its ends is more than twice as wide as the other.
constexpr int most_halves = 16;
// Width of the smallest quadtree cells, px. Eye rays pass only through the corners of cells. So an object
// that is narrower than this may lie between all rays and remain unseen.
constexpr double narrowest_px = 1.0 / (1 << SmallThings::most_levels);

// An ellipsoid that approximates an object: its centre and three half axes.
struct Axes {
    dvec3 centre{0};
    std::array<dvec3, 3> half{};
    // For a cone: relative widths of its two ends, at centre - half[0] (`ends`.x) and at centre + half[0]
    // (`ends`.y). The vector half[0] is half the cone's axis, and half[1] and half[2] lie across it. At each
    // end, half[1] and half[2] must be multiplied by the relative width. For all other shapes, both are 1.
    dvec2 ends{1};

    [[nodiscard]] Axes moved(const glm::dmat4& m) const {
        const auto vector = [&](const dvec3& v) { return dvec3(m * glm::dvec4(v, 0)); };
        return {dvec3(m * glm::dvec4(centre, 1)), {vector(half[0]), vector(half[1]), vector(half[2])}, ends};
    }
};

std::array<dvec3, 2> perpendicular_to(const dvec3& axis) {
    const dvec3 other = std::abs(axis.x) < 0.9 * glm::length(axis) ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 u = glm::normalize(glm::cross(axis, other));
    return {u, glm::normalize(glm::cross(axis, u))};
}

/// Returns the centre and the three half axes of a box. The directions of its axes are the columns of the
/// matrix `turn`. `sides` contains the box's least and greatest coordinates along these axes.
Axes box(const Bounds& sides, const dmat3& turn = dmat3(1)) {
    const dvec3 h = (sides.max - sides.min) / 2.0;
    return {turn * ((sides.min + sides.max) / 2.0), {h.x * turn[0], h.y * turn[1], h.z * turn[2]}};
}

/// Returns a small box that contains all points. Two boxes are computed, and the one with the smaller surface
/// area is returned. The first box is parallel to the coordinate axes. The second box is turned so that one
/// of its axes points to the point farthest from the centre.
Axes box_around(const std::vector<glm::vec3>& points) {
    const auto sides = [&](const dmat3& turn) {
        Bounds out;
        for (const glm::vec3& p : points) out.add(dvec3(p) * turn);
        return out;
    };
    const auto surface = [](const Bounds& b) {
        const dvec3 size = b.max - b.min;
        return size.x * size.y + size.y * size.z + size.z * size.x;
    };
    const Bounds straight = sides(dmat3(1));
    const dvec3 centre = (straight.min + straight.max) / 2.0;
    const auto longest = [&](const auto& vector) {
        dvec3 out(0);
        for (const glm::vec3& p : points) {
            const dvec3 v = vector(dvec3(p) - centre);
            if (glm::dot(v, v) > glm::dot(out, out)) out = v;
        }
        return out;
    };
    const dvec3 first = longest([](const dvec3& v) { return v; });
    const double length = glm::length(first);
    if (!(length > 0)) return box(straight);
    const dvec3 u = first / length, second = longest([&](const dvec3&v) { return v - glm::dot(v, u) * u; });
    const bool is_line = glm::length(second) <= 1e-6 * length;
    const dvec3 v = is_line ? perpendicular_to(u)[0] : glm::normalize(second);
    const dmat3 turn(u, v, glm::cross(u, v));
    const Bounds turned = sides(turn);
    return surface(turned) < surface(straight) ? box(turned, turn) : box(straight);
}

/// The boxes around the parts of a mesh (ObjectParts::of_mesh).
std::vector<Axes> boxes_around(const Mesh& mesh, const std::vector<std::uint32_t>& parts) {
    if (mesh.triangles.empty()) return {};
    const auto part_of = [&](std::uint32_t triangle) { return parts.empty() ? 0 : parts[triangle]; };
    std::vector<std::uint32_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return part_of(a) < part_of(b); });
    std::vector<Axes> out;
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (int k = 0; k < 3; ++k) points.push_back(mesh.positions[mesh.triangles[order[i]][k]]);
        if (i + 1 < order.size() && part_of(order[i + 1]) == part_of(order[i])) continue;
        out.push_back(box_around(points));
        points.clear();
    }
    return out;
}

/// Approximates each connected part of an object by an ellipsoid, from which its width and length in the
/// image are computed later. The ellipsoids are in object space. An infinite plane has none.
struct AxesOf {
    const std::vector<std::uint32_t>& parts;
    std::map<const Mesh*, std::vector<Axes>>& of_meshes;  ///< known so far

    std::vector<Axes> operator()(const Plane&) const { return {}; }
    std::vector<Axes> operator()(const Sphere& s) const {
        return {box({s.centre - dvec3(s.radius), s.centre + dvec3(s.radius)})};
    }
    std::vector<Axes> operator()(const Box& b) const { return {box({b.min, b.max})}; }
    std::vector<Axes> operator()(const Disc& d) const {
        const auto [u, v] = perpendicular_to(d.normal);
        return {{d.centre, {u * d.radius, v * d.radius, dvec3(0)}}};
    }
    std::vector<Axes> operator()(const Rectangle& r) const {
        return {{r.corner + (r.edge_u + r.edge_v) / 2.0, {r.edge_u / 2.0, r.edge_v / 2.0, dvec3(0)}}};
    }
    std::vector<Axes> operator()(const Cone& c) const {
        const auto [u, v] = perpendicular_to(c.apex - c.base);
        const double radius = std::max(std::abs(c.base_radius), std::abs(c.apex_radius));
        return {{(c.base + c.apex) / 2.0,
                 {(c.apex - c.base) / 2.0, u * radius, v * radius},
                 radius > 0 ? dvec2(std::abs(c.base_radius), std::abs(c.apex_radius)) / radius : dvec2(1)}};
    }
    std::vector<Axes> operator()(const std::shared_ptr<const Mesh>& mesh) const {
        const auto [at, is_new] = of_meshes.try_emplace(mesh.get());
        if (is_new) at->second = boxes_around(*mesh, parts);
        return at->second;
    }
};

double cross(const dvec2& a, const dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

// Approximates the camera's projection near a point by a linear function, with which the image size of a
// small object is computed.
struct Sight {
    Sight(const CameraModel& of, const dvec3& point)
        : camera(of), perspective(of.projection == Camera::Projection::perspective) {
        const dvec3 there = point - of.position;
        depth_m = glm::dot(there, of.forward);
        px_per_m = perspective ? 1 / (depth_m * of.tangent_per_px) : 1e3 / of.pixel_pitch_mm;
        if (perspective) slope = dvec2(glm::dot(there, of.right), glm::dot(there, of.down)) / depth_m;
    }
    [[nodiscard]] dvec2 px_of(const dvec3& v) const {
        return (dvec2(glm::dot(v, camera.right), glm::dot(v, camera.down)) -
                glm::dot(v, camera.forward) * slope) *
               px_per_m;
    }
    const CameraModel& camera;
    bool perspective;
    double depth_m = 0, px_per_m = 0;
    dvec2 slope{0};
};

// Replaces the three half axes of an ellipsoid by others that describe the same ellipsoid. Its image is an
// ellipse. The first two new axes project to the half axes of this ellipse, the longer one first. The third
// is along the line of sight.
// Returns the ratio of the ellipse's axes, at least 1, or 0 if the ellipsoid is not visible.
double turn_to_sight(const CameraModel& camera, Axes& axes) {
    const Sight sight(camera, axes.centre);
    std::array<dvec2, 3> seen{};
    double xx = 0, xy = 0, yy = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        seen[k] = sight.px_of(axes.half[k]);
        xx += seen[k].x * seen[k].x;
        xy += seen[k].x * seen[k].y;
        yy += seen[k].y * seen[k].y;
    }
    const double middle = (xx + yy) / 2, apart = std::hypot((xx - yy) / 2, xy), longest = middle + apart;
    if (!(sight.depth_m > 0 && longest > 0)) return 0;
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    const dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
    // Returns the components of the three projected half axes along `direction`.
    const auto weights = [&](const dvec2& direction) {
        return dvec3(glm::dot(seen[0], direction), glm::dot(seen[1], direction),
                     glm::dot(seen[2], direction));
    };
    const dvec3 first = glm::normalize(weights(along));
    dvec3 second = weights(across);
    const double narrow = glm::length(second);
    if (narrow > 1e-9 * std::sqrt(longest))
        second /= narrow;
    else
        second = perpendicular_to(first)[0];
    const dvec3 third = glm::cross(first, second);
    const auto turned = [half = axes.half](const dvec3& w) {
        return w.x * half[0] + w.y * half[1] + w.z * half[2];
    };
    axes.half = {turned(first), turned(second), turned(third)};
    return std::sqrt(longest) / std::max(narrow, 1e-9 * std::sqrt(longest));
}

/// Divides a long object into straight pieces along its longest axis, and calls take(from, to, half) for each
/// of them. `from` and `to` are the ends of the piece's axis. half[1] and half[2] are the piece's half axes
/// across it, whereas half[0] is half the axis of the whole object. A compact object is a single piece, for
/// which `from` and `to` are both its centre.
template <typename Take>
void each_piece(Axes axes, const CameraModel& camera, const Take& take) {
    const bool tapers = axes.ends.x != axes.ends.y;
    if (!tapers) {
        std::sort(axes.half.begin(), axes.half.end(),
                  [](const dvec3& a, const dvec3& b) { return glm::dot(a, a) > glm::dot(b, b); });
    }
    if (!tapers && glm::length(axes.half[0]) <= 4 * glm::length(axes.half[1])) {
        const double narrower = turn_to_sight(camera, axes);
        if (!(narrower > 4)) {
            take(axes.centre, axes.centre, axes.half);
            return;
        }
    }
    const dvec3& axis = axes.half[0];
    const auto width_at = [&](double along) { return glm::mix(axes.ends.x, axes.ends.y, along); };
    const auto take_between = [&](double begin, double end) {
        const double width = width_at((begin + end) / 2);
        take(axes.centre + axis * (2 * begin - 1), axes.centre + axis * (2 * end - 1),
             std::array{axis, width * axes.half[1], width * axes.half[2]});
    };
    for (int i = 0; i < pieces; ++i) {
        double begin = static_cast<double>(i) / pieces, end = static_cast<double>(i + 1) / pieces;
        for (int k = 0; k < most_halves; ++k) {
            const double middle = (begin + end) / 2;
            if (width_at(begin) > 2 * width_at(end)) {
                take_between(begin, middle);
                begin = middle;
            } else if (width_at(end) > 2 * width_at(begin)) {
                take_between(middle, end);
                end = middle;
            } else {
                break;
            }
        }
        take_between(begin, end);
    }
}

double distance_to_segment(const dvec2& p, const dvec2& a, const dvec2& b) {
    const dvec2 ab = b - a;
    const double squared = glm::dot(ab, ab);
    const double t = squared > 0 ? std::clamp(glm::dot(p - a, ab) / squared, 0.0, 1.0) : 0;
    return glm::length(p - (a + t * ab));
}

}  // namespace

SmallThings::SmallThings(const Scene& scene, const ObjectParts& parts, const CameraModel& camera,
                         double time_s, int x_begin, int x_end, int y_begin, int y_end)
    : x_begin_(x_begin),
      x_end_(x_end),
      y_begin_(y_begin),
      y_end_(y_end),
      images_(scene, time_s, most_cells_per_pixel * raster_px()) {
    std::map<const Mesh*, std::vector<Axes>> of_meshes;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
        const Object& o = scene.objects[i];
        const dvec3& emission = scene.materials[o.material].emission;
        const double brightness = std::max({emission.x, emission.y, emission.z});
        for (const Axes& axes : std::visit(AxesOf{parts.of_mesh(i), of_meshes}, o.shape)) {
            each_piece(axes.moved(world_at(o, time_s)), camera,
                       [&](const dvec3& from, const dvec3& to, const std::array<dvec3, 3>& half) {
                           add_piece(from, to, half, brightness, i, camera);
                       });
        }
    }
    keep_affordable();
    for (const Piece& r : pieces_) {
        const double finest = std::min(r.find_px, r.outline_px);
        levels_ = std::max(levels_, static_cast<int>(std::ceil(-std::log2(finest) - 1e-9)));
    }
    if (!images_.empty()) levels_ = std::max(levels_, BrightImages::most_levels);
    levels_ = std::clamp(levels_, 0, most_levels);
    index_tiles();
}

void SmallThings::find_outlines(const Scene& scene, const ObjectParts& parts, const CameraModel& camera,
                                double time_s) {
    outlines_ = {scene,
                 parts,
                 camera,
                 time_s,
                 static_cast<int>(x_begin_),
                 static_cast<int>(x_end_),
                 static_cast<int>(y_begin_),
                 static_cast<int>(y_end_)};
}

void SmallThings::add_piece(const dvec3& from, const dvec3& to, const std::array<dvec3, 3>& half,
                            double brightness, std::uint32_t object, const CameraModel& camera) {
    const auto a = camera.place(from), b = camera.place(to);
    if (!a || !b) return;
    const Sight sight(camera, (from + to) / 2.0);
    std::array<dvec2, 3> seen{};
    double half_depth_m = std::abs(glm::dot(to - from, camera.forward)) / 2;
    for (std::size_t k = 0; k < 3; ++k) {
        seen[k] = sight.px_of(half[k]);
        if (k > 0 || from == to) half_depth_m += std::abs(glm::dot(half[k], camera.forward));
    }
    const dvec2 longest = *std::max_element(seen.begin(), seen.end(), [](const dvec2& p, const dvec2& q) {
        return glm::length(p) < glm::length(q);
    });
    if (!(glm::length(longest) > 0)) return;
    double across = 0;
    for (const dvec2& h : seen) across = std::hypot(across, cross(longest, h) / glm::length(longest));
    Piece r;
    r.from = *a;
    r.to = *b;
    r.width = 2 * across;
    r.reach = from == to ? std::hypot(glm::length(seen[0]), glm::length(seen[1]), glm::length(seen[2]))
                         : std::hypot(glm::length(seen[1]), glm::length(seen[2]));
    if (std::max(a->x, b->x) < x_begin_ - r.reach || std::min(a->x, b->x) > x_end_ + r.reach ||
        std::max(a->y, b->y) < y_begin_ - r.reach || std::min(a->y, b->y) > y_end_ + r.reach ||
        r.width > widest_px)
        return;
    r.object = object;
    if (r.width < (brightness > 1 ? narrowest_px : std::max(narrowest_px, affordable_px_))) {
        lost_.insert(object);
        return;
    }
    r.nearest_m = sight.perspective ? sight.depth_m - half_depth_m : -std::numeric_limits<double>::infinity();
    r.brightness = brightness;
    constexpr double finest = 1.0 / (1 << most_levels);
    r.find_px = std::max(r.width * find_share, finest);
    // Sets the largest size, px, of the quadtree cells at the outline of one piece of a narrow object. `from`
    // and `to` are the ends of the piece's axis. If they are equal, the object is compact. A compact bright
    // object needs small cells, because its area on the raster, and thus its brightness, must be accurate.
    // For a long object, cells of 1 px suffice, because the errors at its many cells average out.
    r.outline_px = brightness > 1 && from == to ? std::max(r.width * bright_share, finest) : 1;
    pieces_.push_back(r);
    // Limits the memory for `pieces_`, the pieces into which narrow objects are divided. Each piece will need
    // at least three quadtree cells, but the number of cells is limited. So if there are more than half as
    // many pieces as allowed cells, not all of them can be kept, and some are discarded now.
    if (static_cast<double>(pieces_.size()) > most_cells_per_pixel / 2 * raster_px() + (1 << 16))
        keep_affordable();
}

double SmallThings::Piece::cells() const {
    const double length = glm::length(to - from) + 2 * reach;
    return length * 2 * (reach + find_px) / (find_px * find_px) +
           (outline_px < find_px ? 4 * length / outline_px : 0);
}

double SmallThings::cells() const {
    double out = 0;
    for (const Piece& p : pieces_) out += p.cells();
    return out;
}

std::uint64_t SmallThings::objects() const {
    std::set<std::uint32_t> out;
    for (const Piece& p : pieces_) out.insert(p.object);
    return out.size();
}

void SmallThings::keep_affordable() {
    double left = most_cells_per_pixel * raster_px();
    if (cells() <= left) return;
    std::stable_sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
        const bool a_bright = a.brightness > 1, b_bright = b.brightness > 1;
        return a_bright != b_bright ? a_bright : a.width > b.width;
    });
    std::size_t kept = 0;
    while (kept < pieces_.size() && pieces_[kept].cells() <= left) left -= pieces_[kept++].cells();
    for (std::size_t i = kept; i < pieces_.size(); ++i) lost_.insert(pieces_[i].object);
    if (kept > 0 && !(pieces_[kept - 1].brightness > 1)) affordable_px_ = pieces_[kept - 1].width;
    pieces_.resize(kept);
}

void SmallThings::index_tiles() {
    if (pieces_.empty()) return;
    columns_ = static_cast<int>(std::ceil((x_end_ - x_begin_) / tile_px)) + 1;
    rows_ = static_cast<int>(std::ceil((y_end_ - y_begin_) / tile_px)) + 1;
    const auto visit = [&](const auto& take) {
        for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
            const Piece& r = pieces_[i];
            const double reach = r.reach + 1;
            const auto tile = [](double value, double begin, int count) {
                return static_cast<int>(std::clamp(std::floor((value - begin) / tile_px), 0.0, count - 1.0));
            };
            const int left = tile(std::min(r.from.x, r.to.x) - reach, x_begin_, columns_),
                      right = tile(std::max(r.from.x, r.to.x) + reach, x_begin_, columns_),
                      top = tile(std::min(r.from.y, r.to.y) - reach, y_begin_, rows_),
                      bottom = tile(std::max(r.from.y, r.to.y) + reach, y_begin_, rows_);
            for (int y = top; y <= bottom; ++y) {
                for (int x = left; x <= right; ++x) {
                    const dvec2 centre(x_begin_ + (x + 0.5) * tile_px, y_begin_ + (y + 0.5) * tile_px);
                    if (distance_to_segment(centre, r.from, r.to) <= reach + tile_px)
                        take(static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                                 static_cast<std::size_t>(x),
                             i);
                }
            }
        }
    };
    tile_offsets_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    visit([&](std::size_t tile, std::uint32_t) { ++tile_offsets_[tile + 1]; });
    for (std::size_t i = 1; i < tile_offsets_.size(); ++i) tile_offsets_[i] += tile_offsets_[i - 1];
    tile_pieces_.resize(tile_offsets_.back());
    std::vector<std::uint32_t> next(tile_offsets_.begin(), tile_offsets_.end() - 1);
    visit([&](std::size_t tile, std::uint32_t i) { tile_pieces_[next[tile]++] = i; });
}

WantedCells SmallThings::wanted(double x, double y, double size, double farthest_m) const {
    WantedCells out{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    if (pieces_.empty()) return out;
    const dvec2 centre(x + size / 2, y + size / 2);
    const int column = static_cast<int>(std::floor((centre.x - x_begin_) / tile_px)),
              row = static_cast<int>(std::floor((centre.y - y_begin_) / tile_px));
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return out;
    const std::size_t tile =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    for (std::uint32_t i = tile_offsets_[tile]; i < tile_offsets_[tile + 1]; ++i) {
        const Piece& r = pieces_[tile_pieces_[i]];
        if (size <= std::min(r.find_px, r.outline_px) || r.nearest_m > farthest_m) continue;
        // Skips pieces of narrow objects that do not overlap the quadtree cell. A piece lies around its axis,
        // the line from r.from to r.to, and extends at most r.reach from it, in px. The square cell extends
        // at most 0.7071 * size from its centre, which is half its diagonal (0.7072 allows for rounding
        // errors). If the centre is farther from the axis than r.reach plus this half diagonal, they do not
        // overlap.
        if (distance_to_segment(centre, r.from, r.to) > r.reach + size * 0.7072) continue;
        out.find_px = std::min(out.find_px, r.find_px);
        out.outline_px = std::min(out.outline_px, r.outline_px);
    }
    return out;
}

}  // namespace postlens
