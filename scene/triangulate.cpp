#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

// Returns twice the signed area of the triangle a, b, c.
double turn(const dvec2& a, const dvec2& b, const dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

dvec3 newell_normal(std::span<const dvec3> polygon) {
    // The sum of the cross products of successive corners is a normal of the polygon. Corners are taken
    // relative to the first one, because the products of large coordinates would lose precision if the
    // polygon is far from the origin.
    dvec3 normal(0);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        normal += glm::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    }
    return normal;
}

// Projects the polygon along the coordinate axis closest to its normal. The result runs counterclockwise.
std::vector<dvec2> flattened(std::span<const dvec3> polygon, const dvec3& normal) {
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
        if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
    }
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    std::vector<dvec2> out;
    out.reserve(polygon.size());
    for (const dvec3& p : polygon) {
        const dvec3 q = p - polygon[0];
        out.emplace_back(normal[axis] > 0 ? dvec2(q[a], q[b]) : dvec2(q[b], q[a]));
    }
    return out;
}

// Total turning angle of an outline: 2 pi if simple, 0 for a figure eight, 4 pi for a five-pointed star.
struct Turning {
    double total = 0;
    bool only_left = true;
};

Turning turning(const std::vector<dvec2>& corners, double no_turn) {
    std::vector<dvec2> p;  // without repeated corners: an edge of length 0 has no direction
    for (const dvec2& q : corners) {
        if (p.empty() || p.back() != q) p.push_back(q);
    }
    while (p.size() > 1 && p.back() == p.front()) p.pop_back();
    Turning out;
    for (std::size_t i = 0, n = p.size(); i < n; ++i) {
        const dvec2 &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
        const double t = turn(a, b, c);
        out.only_left = out.only_left && t >= -no_turn;
        out.total += std::atan2(t, glm::dot(b - a, c - b));
    }
    return out;
}

bool covers(const dvec2& a, const dvec2& b, const dvec2& c, const dvec2& p) {
    if (p == a || p == b || p == c) return false;  // a repeated corner, as where a bridge leads to a hole
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

bool is_ear(const std::vector<dvec2>& p, const std::vector<std::uint32_t>& left, std::size_t i) {
    const std::size_t n = left.size();
    const dvec2 &a = p[left[(i + n - 1) % n]], &b = p[left[i]], &c = p[left[(i + 1) % n]];
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t j = 0; j < n; ++j) {
        if (covers(a, b, c, p[left[j]])) return false;
    }
    return true;
}

}  // namespace

Triangulation triangulate(std::span<const dvec3> polygon) {
    Triangulation out;
    const dvec3 normal = newell_normal(polygon);
    double longest2 = 0;
    for (const dvec3& p : polygon) longest2 = std::max(longest2, glm::dot(p - polygon[0], p - polygon[0]));
    // If twice an area is below this limit, it counts as 0, because rounding errors of the coordinates may
    // have caused it. The limit is 1e-14 times the squared distance from the first corner to the farthest
    // one.
    const double no_turn = 1e-14 * longest2;
    if (!(glm::length(normal) > no_turn)) {
        out.fault = PolygonFault::no_area;
        return out;
    }
    const std::vector<dvec2> p = flattened(polygon, normal);
    const auto n = static_cast<std::uint32_t>(p.size());
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (turn(p[a], p[b], p[c]) > no_turn) out.triangles.emplace_back(a, b, c);
    };
    const Turning outline = turning(p, no_turn);
    if (std::abs(outline.total - 2 * std::numbers::pi) > 1) {
        out.fault = PolygonFault::crosses_itself;
        return out;
    }
    if (outline.only_left) {
        for (std::uint32_t i = 1; i + 1 < n; ++i) add(0, i, i + 1);
        return out;
    }
    std::vector<std::uint32_t> left(n);
    std::iota(left.begin(), left.end(), 0U);
    std::size_t at = 0, tried = 0;
    while (left.size() > 3) {
        const std::size_t m = left.size();
        at %= m;
        const std::uint32_t a = left[(at + m - 1) % m], b = left[at], c = left[(at + 1) % m];
        const bool straight = std::abs(turn(p[a], p[b], p[c])) <= no_turn;
        if (straight || is_ear(p, left, at)) {
            if (!straight) add(a, b, c);
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
            tried = 0;
            // Skips the next corner: cutting off ears at two adjacent corners would give thin triangles.
            ++at;
        } else {
            ++at;
            if (++tried > m) {
                out.triangles.clear();
                out.fault = PolygonFault::crosses_itself;
                return out;
            }
        }
    }
    add(left[0], left[1], left[2]);
    if (out.triangles.empty()) out.fault = PolygonFault::no_area;
    return out;
}

}  // namespace postlens
