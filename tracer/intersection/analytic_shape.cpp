#include "tracer/intersection/analytic_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace postlens {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec2;
using glm::dvec3;

dmat4 frame(const dvec3& x, const dvec3& y, const dvec3& z, const dvec3& origin) {
    return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(origin, 1)};
}

// Returns a right-handed frame whose z axis is the unit vector `axis`.
// Its x axis, where the texture coordinate u is 0, is the direction perpendicular to `axis` that is closest
// to the object's +X. If `axis` is itself close to X, +Y is used instead.
dmat4 frame_about(const dvec3& axis, const dvec3& origin) {
    const dvec3 hint = std::abs(axis.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 x = glm::normalize(hint - axis * glm::dot(hint, axis));
    return frame(x, glm::cross(axis, x), axis, origin);
}

template <typename T>
void quadratic(T a, T half_b, T c, T shift, int part, Crossings<T>& out) {
    // Solves a t^2 + 2 half_b t + c = 0 without cancellation.
    const T discriminant = half_b * half_b - a * c;
    if (!(discriminant >= 0)) return;
    const T q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    if (a != 0) out.add(shift + q / a, part);
    if (q != 0) out.add(shift + c / q, part);
    if (q == 0 && a != 0) out.add(shift, part);
}

template <typename T>
void sphere_crossings(const glm::vec<3, T>& o, const glm::vec<3, T>& d, Crossings<T>& out) {
    // Measures t from the ray's point nearest to the sphere, so that a distant origin causes no cancellation.
    const T dd = glm::dot(d, d);
    const T tc = -glm::dot(o, d) / dd;
    const glm::vec<3, T> l = o + tc * d;
    const T h2 = (T(1) - glm::dot(l, l)) / dd;
    if (!(h2 >= 0)) return;
    const T h = std::sqrt(h2);
    out.add(tc - h, 0);
    out.add(tc + h, 0);
}

template <typename T>
void box_crossings(const glm::vec<3, T>& o, const glm::vec<3, T>& d, Crossings<T>& out) {
    T t_in = -std::numeric_limits<T>::infinity(), t_out = std::numeric_limits<T>::infinity();
    int part_in = 0, part_out = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) {
            if (o[axis] < 0 || o[axis] > 1) return;
            continue;
        }
        T t0 = -o[axis] / d[axis], t1 = (T(1) - o[axis]) / d[axis];
        int p0 = 2 * axis, p1 = 2 * axis + 1;
        if (t0 > t1) {
            std::swap(t0, t1);
            std::swap(p0, p1);
        }
        if (t0 > t_in) t_in = t0, part_in = p0;
        if (t1 < t_out) t_out = t1, part_out = p1;
    }
    if (t_in > t_out) return;
    out.add(t_in, part_in);
    out.add(t_out, part_out);
}

template <typename T>
void flat_crossing(const AnalyticShape& shape, const glm::vec<3, T>& o, const glm::vec<3, T>& d,
                   Crossings<T>& out) {
    if (d.z == 0) return;
    const T t = -o.z / d.z;
    const T x = o.x + t * d.x, y = o.y + t * d.y;
    if (shape.kind == AnalyticShape::Kind::rectangle && !(x >= 0 && x <= 1 && y >= 0 && y <= 1)) return;
    if (shape.kind == AnalyticShape::Kind::disc) {
        const T r2 = x * x + y * y;
        if (!(r2 <= 1 && r2 >= static_cast<T>(shape.inner * shape.inner))) return;
    }
    out.add(t, 0);
}

template <typename T>
void cone_crossings(const AnalyticShape& shape, const glm::vec<3, T>& o, const glm::vec<3, T>& d,
                    Crossings<T>& out) {
    const T h = static_cast<T>(shape.height), r0 = static_cast<T>(shape.radius0),
            r1 = static_cast<T>(shape.radius1);
    const T k = (r1 - r0) / h;
    const T shift = -(o.x * d.x + o.y * d.y + (o.z - h / 2) * d.z) / glm::dot(d, d);
    const glm::vec<3, T> p = o + shift * d;
    const T r = r0 + k * p.z;
    Crossings<T> lateral;
    quadratic(d.x * d.x + d.y * d.y - k * k * d.z * d.z, p.x * d.x + p.y * d.y - r * k * d.z,
              p.x * p.x + p.y * p.y - r * r, T(0), part_lateral, lateral);
    for (int i = 0; i < lateral.count; ++i) {
        const T z = p.z + lateral.t[i] * d.z;
        if (z >= 0 && z <= h && r0 + k * z >= 0) out.add(shift + lateral.t[i], part_lateral);
    }
    if (!shape.capped || d.z == 0) return;
    for (const int part : {part_base, part_apex}) {
        const T z = part == part_base ? T(0) : h, radius = part == part_base ? r0 : r1;
        const T t = (z - p.z) / d.z;
        const T x = p.x + t * d.x, y = p.y + t * d.y;
        if (x * x + y * y <= radius * radius) out.add(shift + t, part);
    }
}

dmat3 tangential(const dvec3& n) {
    return dmat3(1) - glm::outerProduct(n, n);
}

// Geometry of a cone at one point of its lateral surface. `k` is the change of the cone's radius per unit of
// height. The vector (outward.x, outward.y, -k) is normal to the surface, and `norm` is its length.
struct ConeAt {
    double k, norm, rho;  // rho: distance from the axis
    dvec2 outward;        // unit, away from the axis
};
ConeAt cone_at(const AnalyticShape& shape, const dvec3& p) {
    const double k = (shape.radius1 - shape.radius0) / shape.height;
    const double rho = std::max(std::hypot(p.x, p.y), std::numeric_limits<double>::min());
    return {k, std::sqrt(1 + k * k), rho, dvec2(p.x / rho, p.y / rho)};
}

double turn(double x, double y) {  // angle from +X towards +Y as a fraction of a full turn, in [0, 1)
    const double u = std::atan2(y, x) / (2 * std::numbers::pi);
    return u < 0 ? u + 1 : u;
}

}  // namespace

std::optional<PlacedShape> place_shape(const Shape& shape) {
    PlacedShape out;
    using Kind = AnalyticShape::Kind;
    if (const auto* s = std::get_if<Sphere>(&shape)) {
        out.shape.kind = Kind::sphere;
        out.object_from_local =
            frame(dvec3(s->radius, 0, 0), dvec3(0, s->radius, 0), dvec3(0, 0, s->radius), s->centre);
    } else if (const auto* b = std::get_if<Box>(&shape)) {
        out.shape.kind = Kind::box;
        const dvec3 e = b->max - b->min;
        out.object_from_local = frame(dvec3(e.x, 0, 0), dvec3(0, e.y, 0), dvec3(0, 0, e.z), b->min);
    } else if (const auto* d = std::get_if<Disc>(&shape)) {
        out.shape.kind = Kind::disc;
        out.shape.inner = d->inner_radius / d->radius;
        const dmat4 f = frame_about(glm::normalize(d->normal), d->centre);
        out.object_from_local =
            f * frame(dvec3(d->radius, 0, 0), dvec3(0, d->radius, 0), dvec3(0, 0, 1), dvec3(0));
    } else if (const auto* r = std::get_if<Rectangle>(&shape)) {
        out.shape.kind = Kind::rectangle;
        out.object_from_local =
            frame(r->edge_u, r->edge_v, glm::normalize(glm::cross(r->edge_u, r->edge_v)), r->corner);
    } else if (const auto* p = std::get_if<Plane>(&shape)) {
        out.shape.kind = Kind::plane;
        out.object_from_local = frame_about(glm::normalize(p->normal), p->point);
    } else if (const auto* c = std::get_if<Cone>(&shape)) {
        out.shape.kind = Kind::cone;
        const dvec3 axis = c->apex - c->base;
        out.shape.height = glm::length(axis);
        out.shape.radius0 = std::abs(c->base_radius);
        out.shape.radius1 = std::abs(c->apex_radius);
        out.shape.capped = c->capped;
        out.object_from_local = frame_about(axis / out.shape.height, c->base);
    } else {
        return std::nullopt;
    }
    return out;
}

template <typename T>
Crossings<T> crossings(const AnalyticShape& shape, const glm::vec<3, T>& o, const glm::vec<3, T>& d) {
    Crossings<T> out;
    switch (shape.kind) {
        case AnalyticShape::Kind::sphere:
            sphere_crossings(o, d, out);
            break;
        case AnalyticShape::Kind::box:
            box_crossings(o, d, out);
            break;
        case AnalyticShape::Kind::disc:
        case AnalyticShape::Kind::rectangle:
        case AnalyticShape::Kind::plane:
            flat_crossing(shape, o, d, out);
            break;
        case AnalyticShape::Kind::cone:
            cone_crossings(shape, o, d, out);
            break;
    }
    return out;
}
template Crossings<float> crossings(const AnalyticShape&, const glm::vec3&, const glm::vec3&);
template Crossings<double> crossings(const AnalyticShape&, const glm::dvec3&, const glm::dvec3&);

dvec2 local_uv(const AnalyticShape& shape, int part, const dvec3& p) {
    switch (shape.kind) {
        case AnalyticShape::Kind::sphere:
            return {turn(p.x, p.y),
                    std::acos(std::clamp(-p.z / glm::length(p), -1.0, 1.0)) / std::numbers::pi};
        case AnalyticShape::Kind::box: {
            const int axis = part / 2;
            return axis == 0 ? dvec2(p.y, p.z) : axis == 1 ? dvec2(p.x, p.z) : dvec2(p.x, p.y);
        }
        case AnalyticShape::Kind::disc:
            return {turn(p.x, p.y), std::hypot(p.x, p.y)};
        case AnalyticShape::Kind::rectangle:
        case AnalyticShape::Kind::plane:
            return {p.x, p.y};
        case AnalyticShape::Kind::cone:
            break;
    }
    return {turn(p.x, p.y), p.z / shape.height};
}

dvec3 local_normal(const AnalyticShape& shape, int part, const dvec3& p) {
    dvec3 normal(0);
    switch (shape.kind) {
        case AnalyticShape::Kind::sphere:
            return glm::normalize(p);
        case AnalyticShape::Kind::box:
            normal[part / 2] = part % 2 == 0 ? -1 : 1;
            return normal;
        case AnalyticShape::Kind::disc:
        case AnalyticShape::Kind::rectangle:
        case AnalyticShape::Kind::plane:
            return {0, 0, 1};
        case AnalyticShape::Kind::cone:
            break;
    }
    if (part != part_lateral) return {0, 0, part == part_base ? -1 : 1};
    const ConeAt at = cone_at(shape, p);
    return dvec3(at.outward, -at.k) / at.norm;
}

dmat3 local_shape_operator(const AnalyticShape& shape, int part, const dvec3& p) {
    if (shape.kind == AnalyticShape::Kind::sphere) return tangential(glm::normalize(p));
    if (shape.kind != AnalyticShape::Kind::cone || part != part_lateral) return dmat3(0);
    // Returns the derivative of a cone's normal with respect to position. The normal is (e, -k) / norm, where
    // e is the unit vector away from the axis, and k and norm are constants. The derivative of e is (I - e
    // e^T) / rho, where rho is the distance from the axis.
    const ConeAt at = cone_at(shape, p);
    const dvec2 e = at.outward;
    const double s = 1 / (at.rho * at.norm);
    return {dvec3(e.y * e.y, -e.x * e.y, 0) * s, dvec3(-e.x * e.y, e.x * e.x, 0) * s, dvec3(0)};
}

}  // namespace postlens
