#include "tracer/recording/mesh_outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/threads.h"
#include "scene/object_pose.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

/// A part of a line segment. Its ends are fractions of the length of the segment.
struct Range {
    double begin = 0, end = 1;
};

std::optional<Range> clip(const dvec2& from, const dvec2& to, const dvec2& low, const dvec2& high) {
    Range out;
    for (int axis = 0; axis < 2; ++axis) {
        const double step = to[axis] - from[axis];
        if (step == 0) {
            if (from[axis] < low[axis] || from[axis] > high[axis]) return std::nullopt;
            continue;
        }
        double enters = (low[axis] - from[axis]) / step, leaves = (high[axis] - from[axis]) / step;
        if (enters > leaves) std::swap(enters, leaves);
        out.begin = std::max(out.begin, enters);
        out.end = std::min(out.end, leaves);
    }
    if (!(out.begin <= out.end)) return std::nullopt;
    return out;
}

}  // namespace

MeshOutlines::MeshOutlines(const Scene& scene, const ObjectParts& parts, const CameraModel& camera,
                           double time_s, int x_begin, int x_end, int y_begin, int y_end)
    : orthographic_(camera.projection == Camera::Projection::orthographic),
      x_begin_(x_begin),
      x_end_(x_end),
      y_begin_(y_begin),
      y_end_(y_end) {
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&scene.objects[i].shape);
        if (mesh != nullptr) add_mesh(scene.objects[i], **mesh, i, parts, camera, time_s);
    }
    index_rows();
}

void MeshOutlines::add_mesh(const Object& object, const Mesh& mesh, std::size_t index,
                            const ObjectParts& parts, const CameraModel& camera, double time_s) {
    const glm::dmat4 world = world_at(object, time_s);
    struct Place {
        dvec2 at{std::numeric_limits<double>::quiet_NaN()};  ///< NaN: behind the pinhole
        double nearness = 0;
    };
    std::vector<Place> places(mesh.positions.size());
    constexpr std::size_t chunk = 4096;
    parallel_for((places.size() + chunk - 1) / chunk, [&](std::size_t c) {
        for (std::size_t i = c * chunk; i < std::min((c + 1) * chunk, places.size()); ++i) {
            const dvec3 point(world * glm::dvec4(dvec3(mesh.positions[i]), 1));
            const auto at = camera.place(point);
            if (at) places[i] = {*at, nearness(glm::dot(point - camera.position, camera.forward))};
        }
    });
    // Returns twice the signed area of a triangle's image. The sign shows which side the camera sees.
    const auto area = [&](std::uint32_t triangle) {
        const glm::uvec3& t = mesh.triangles[triangle];
        const dvec2 u = places[t[1]].at - places[t[0]].at, v = places[t[2]].at - places[t[0]].at;
        return u.x * v.y - u.y * v.x;
    };
    const dvec2 low(x_begin_, y_begin_), high(x_end_, y_end_);
    for (const MeshEdge& edge : parts.edges(index)) {
        if (edge.other != MeshEdge::none && area(edge.triangle) * area(edge.other) > 0) continue;
        const Place &a = places[edge.low_end], &b = places[edge.high_end];
        const double length = glm::length(b.at - a.at);
        const auto in = std::isfinite(length) ? clip(a.at, b.at, low, high) : std::nullopt;
        if (!in) continue;
        const auto nearness_at = [&](double t) {
            return static_cast<float>(glm::mix(a.nearness, b.nearness, t));
        };
        edges_.push_back({glm::mix(a.at, b.at, in->begin), glm::mix(a.at, b.at, in->end),
                          nearness_at(in->begin), nearness_at(in->end), object.id,
                          parts.any() ? parts.part(index, edge.triangle) : 0});
    }
}

template <typename Take>
void MeshOutlines::each_pixel(const Edge& edge, const Take& take) const {
    const dvec2 from(edge.from), to(edge.to);
    const auto pixel = [](double at, int begin, int end) {
        return static_cast<int>(std::clamp(std::floor(at), static_cast<double>(begin), end - 1.0));
    };
    const int top = pixel(std::min(from.y, to.y), y_begin_, y_end_),
              bottom = pixel(std::max(from.y, to.y), y_begin_, y_end_);
    for (int y = top; y <= bottom; ++y) {
        const auto in = clip(from, to, dvec2(x_begin_, y), dvec2(x_end_, y + 1));
        if (!in) continue;
        const double a = glm::mix(from.x, to.x, in->begin), b = glm::mix(from.x, to.x, in->end);
        const int right = pixel(std::max(a, b), x_begin_, x_end_);
        for (int x = pixel(std::min(a, b), x_begin_, x_end_); x <= right; ++x) take(x, y);
    }
}

void MeshOutlines::index_rows() {
    std::stable_sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
        return a.from_nearness + a.to_nearness > b.from_nearness + b.to_nearness;
    });
    const auto rows = static_cast<std::size_t>(y_end_ - y_begin_);
    const auto most = static_cast<std::size_t>(most_per_pixel * (x_end_ - x_begin_) * (y_end_ - y_begin_));
    row_begin_.assign(rows + 1, 0);
    std::size_t crossings = 0, kept = 0;
    for (; kept < edges_.size() && crossings < most; ++kept) {
        each_pixel(edges_[kept], [&](int, int y) {
            ++row_begin_[static_cast<std::size_t>(y - y_begin_) + 1];
            ++crossings;
        });
    }
    edges_.resize(kept);
    edges_.shrink_to_fit();
    for (std::size_t row = 0; row < rows; ++row) row_begin_[row + 1] += row_begin_[row];
    crossings_.resize(crossings);
    std::vector<std::size_t> next(row_begin_.begin(), row_begin_.end() - 1);
    for (std::uint32_t i = 0; i < edges_.size(); ++i)
        each_pixel(edges_[i], [&](int x, int y) {
            crossings_[next[static_cast<std::size_t>(y - y_begin_)]++] = {x, i};
        });
    parallel_for(rows, [&](std::size_t row) {
        std::sort(crossings_.begin() + static_cast<std::ptrdiff_t>(row_begin_[row]),
                  crossings_.begin() + static_cast<std::ptrdiff_t>(row_begin_[row + 1]),
                  [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    });
}

bool MeshOutlines::cross(double x, double y, double size, const Shown& shown) const {
    const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    if (empty() || row < y_begin_ || row >= y_end_) return false;
    const auto first = crossings_.begin() +
                       static_cast<std::ptrdiff_t>(row_begin_[static_cast<std::size_t>(row - y_begin_)]),
               last = crossings_.begin() +
                      static_cast<std::ptrdiff_t>(row_begin_[static_cast<std::size_t>(row - y_begin_) + 1]);
    // Tests whether an edge of a mesh crosses the square from (x, y), `size` px wide. The square is made
    // slightly smaller for this test. Otherwise, an edge that runs along a side of the square would count as
    // crossing it.
    const double margin = size / 64;
    const dvec2 low(x + margin, y + margin), high(x + size - margin, y + size - margin);
    for (auto c = std::lower_bound(first, last, column, [](const Crossing&a, int to) { return a.x < to; });
         c != last && c->x == column; ++c) {
        const Edge& edge = edges_[c->edge];
        if (edge.id == shown.id && edge.part == shown.part) continue;
        const dvec2 from(edge.from), to(edge.to);
        const auto in = clip(from, to, low, high);
        if (!in) continue;
        const double t = (in->begin + in->end) / 2;
        const dvec2 at = (glm::mix(from, to, t) - dvec2(x, y)) / size;
        const auto corner = [&](std::size_t k) { return nearness(static_cast<double>(shown.z_m[k])); };
        const double behind =
            glm::mix(glm::mix(corner(0), corner(1), at.x), glm::mix(corner(2), corner(3), at.x), at.y);
        // Relative tolerance of a depth. An edge of a mesh may hide something only if it lies in front of the
        // surface that the cell's corners show. Because of rounding errors, an edge that lies in this surface
        // may seem to be slightly in front of it.
        constexpr double in_plane = 1e-4;
        if (!std::isfinite(behind) ||
            glm::mix(static_cast<double>(edge.from_nearness), static_cast<double>(edge.to_nearness), t) >
                behind + in_plane * std::abs(behind))
            return true;
    }
    return false;
}

}  // namespace postlens
