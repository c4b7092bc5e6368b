#include "scene/shape_bounds.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

using glm::dmat3;
using glm::dvec3;

dvec3 to_world(const glm::dmat4& m, const dvec3& p) {
    return dvec3(m * glm::dvec4(p, 1));
}

Bounds around(const dvec3& centre, const dvec3& half) {
    return {centre - half, centre + half};
}

// Returns the half extents, along the world axes, of a disc that is transformed by M = `linear`. For each
// world axis e, this is the radius times the length of M^T e projected onto the disc's plane.
dvec3 disc_half_extent(const dmat3& linear, const dvec3& unit_normal, double radius) {
    dvec3 half;
    const dmat3 rows = glm::transpose(linear);
    for (int axis = 0; axis < 3; ++axis) {
        const dvec3 e = rows[axis];
        half[axis] = radius * glm::length(e - unit_normal * glm::dot(unit_normal, e));
    }
    return half;
}

struct BoundsOf {
    const glm::dmat4& m;

    Bounds operator()(const Sphere& s) const {
        const dmat3 rows = glm::transpose(dmat3(m));
        const double r = std::abs(s.radius);
        return around(to_world(m, s.centre),
                      r * dvec3(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2])));
    }
    Bounds operator()(const Box& b) const {
        Bounds out;
        for (int corner = 0; corner < 8; ++corner) {
            out.add(to_world(m, {corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                                 corner & 4 ? b.max.z : b.min.z}));
        }
        return out;
    }
    Bounds operator()(const Disc& d) const {
        return around(to_world(m, d.centre), disc_half_extent(dmat3(m), glm::normalize(d.normal), d.radius));
    }
    Bounds operator()(const Rectangle& r) const {
        Bounds out;
        for (const dvec3& p :
             {r.corner, r.corner + r.edge_u, r.corner + r.edge_v, r.corner + r.edge_u + r.edge_v}) {
            out.add(to_world(m, p));
        }
        return out;
    }
    Bounds operator()(const Plane&) const {
        const dvec3 all(std::numeric_limits<double>::infinity());
        return {-all, all};
    }
    Bounds operator()(const Cone& c) const {
        const dvec3 axis = glm::normalize(c.apex - c.base);
        Bounds out = around(to_world(m, c.base), disc_half_extent(dmat3(m), axis, std::abs(c.base_radius)));
        out.add(around(to_world(m, c.apex), disc_half_extent(dmat3(m), axis, std::abs(c.apex_radius))));
        return out;
    }
    Bounds operator()(const std::shared_ptr<const Mesh>& mesh) const {
        Bounds out;
        for (const glm::vec3& p : mesh->positions) out.add(to_world(m, dvec3(p)));
        return out;
    }
};

}  // namespace

Bounds shape_bounds(const Shape& shape, const glm::dmat4& world_from_object) {
    return std::visit(BoundsOf{world_from_object}, shape);
}

}  // namespace postlens
