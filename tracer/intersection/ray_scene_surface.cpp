// Computes hits again in double precision.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tracer/intersection/ray_scene_impl.h"

namespace postlens {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

dmat4 InstanceGeometry::at(double time) const {
    if (world_from_object.size() == 1) return world_from_object.front();
    const auto last = static_cast<double>(world_from_object.size() - 1);
    const double position = std::clamp((time - begin) / per_step, 0.0, last);
    const auto k = static_cast<std::size_t>(std::min(position, last - 1));
    const double share = position - static_cast<double>(k);
    return world_from_object[k] * (1 - share) + world_from_object[k + 1] * share;
}

SurfacePoint RayScene::Impl::sphere_surface(std::uint32_t primitive, const dvec3& o, const dvec3& d,
                                            double t) const {
    const dvec3 c = spheres.exact_centre[primitive];
    const double r = spheres.exact_radius[primitive];
    const double tc = glm::dot(c - o, d);
    const dvec3 l = o + tc * d - c;
    const double h = std::sqrt(std::max(0.0, r * r - glm::dot(l, l)));
    SurfacePoint s;
    s.object = spheres.object[primitive];
    s.t = std::abs(tc - h - t) <= std::abs(tc + h - t) ? tc - h : tc + h;
    const dvec3 n = glm::normalize(l + (s.t - tc) * d);
    s.position = c + r * n;
    s.geometric_normal = s.normal = n;
    if (textured(s.object)) {
        s.object_position = dvec3(object_from_world[s.object] * glm::dvec4(s.position, 1));
        const auto& shape = std::get<Sphere>(scene->objects[s.object].shape);
        if (wants_uv(s.object)) s.uv = local_uv({}, 0, (s.object_position - shape.centre) / shape.radius);
    }
    return s;
}

void RayScene::Impl::solve(const AnalyticShape& shape, LocalHit& hit) {
    if (shape.flat()) {
        hit.t = -hit.o.z / hit.d.z;
        return;
    }
    const Crossings<double> found = crossings<double>(shape, hit.o, hit.d);
    const double t = hit.t;  // kept if the ray misses the silhouette in double but hits it in float
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < found.count; ++k) {
        if (std::abs(found.t[k] - t) >= best) continue;
        best = std::abs(found.t[k] - t);
        hit.t = found.t[k];
        hit.part = found.part[k];
    }
}

void RayScene::Impl::look_up_texture(const AnalyticShape& shape, const dmat4& object_from_local,
                                     const LocalHit& hit, SurfacePoint& out) const {
    out.t = hit.t;
    out.part = hit.part;
    if (!textured(out.object)) return;
    const dvec3 local = hit.position();
    if (wants_uv(out.object)) out.uv = local_uv(shape, hit.part, local);
    out.object_position = dvec3(object_from_local * glm::dvec4(local, 1));
}

template <typename Item, typename Normal>
SurfacePoint RayScene::Impl::solved_surface(const Item& item, LocalHit& hit, const dvec3& o, const dvec3& d,
                                            bool normals, const Normal& world_normal) const {
    solve(item.shape, hit);
    SurfacePoint s;
    s.object = item.object;
    look_up_texture(item.shape, item.object_from_local, hit, s);
    if (!normals) return s;
    s.position = o + s.t * d;
    s.geometric_normal = s.normal = world_normal(hit);
    return s;
}

SurfacePoint RayScene::Impl::analytic_surface(const AnalyticSet::Item& item, const dvec3& o, const dvec3& d,
                                              double t, bool normals) const {
    const dmat3 linear(item.local_from_world);
    LocalHit hit{dvec3(item.local_from_world * glm::dvec4(o, 1)), linear * d, t};
    // Normals transform as covectors.
    return solved_surface(item, hit, o, d, normals, [&](const LocalHit& at) {
        return item.shape.flat() ? item.flat_normal
                                 : glm::normalize(local_normal(item.shape, at.part, at.position()) * linear);
    });
}

SurfacePoint RayScene::Impl::moving_surface(std::uint32_t primitive, const dvec3& o, const dvec3& d, double t,
                                            double time, bool normals) const {
    const MovingSet::Item& item = moving.items[primitive];
    const MotionPath::Pose pose = moving.paths[item.path].at(span.at(time));
    const dmat3 base(item.local_from_base);
    LocalHit hit{dvec3(item.local_from_base * glm::dvec4(pose.unmoved_point(o), 1)),
                 base * pose.unmoved_direction(d), t};
    // Returns the surface normal in world space. A direction in the shape's frame is mapped to the world by
    // inverse(base), and then by the scale and the rotation of the motion (`pose`). A normal is mapped by the
    // inverse transpose: rotation * (1 / scale) * transpose(base).
    return solved_surface(item, hit, o, d, normals, [&](const LocalHit& at) {
        const dvec3 n = local_normal(item.shape, at.part, at.position());
        // n * base is transpose(base) * n.
        return glm::normalize(pose.rotation * ((n * base) / pose.scale));
    });
}

TriangleFrame RayScene::Impl::triangle(const HitKey& key, double time) const {
    TriangleFrame f{};
    const bool instanced = key.instance != HitKey::none;
    const Entry& entry = entries[instanced ? key.instance : key.geometry];
    f.mesh = &meshes[instanced ? instances[entry.index].mesh : entry.index];
    f.object = instanced ? instances[entry.index].object : f.mesh->object;
    f.corners = f.mesh->triangles[key.primitive];
    f.object_from_world = object_from_world[f.object];
    const InstanceGeometry* instance = instanced ? &instances[entry.index] : nullptr;
    dmat4 moved(1);
    if (instanced) {
        moved = instance->at(time);
        const bool asked = textured(f.object) || !f.mesh->mesh->normals.empty();
        if (asked && instance->world_from_object.size() > 1) f.object_from_world = glm::inverse(moved);
    }
    const auto world = [&](std::uint32_t i) {
        const dvec3 p(f.mesh->positions[i]);
        return instanced ? dvec3(moved * glm::dvec4(p, 1)) : p;
    };
    f.a = world(f.corners.x);
    const dvec3 e1 = world(f.corners.y) - f.a, e2 = world(f.corners.z) - f.a;
    f.cross = glm::cross(e1, e2);
    f.area2 = glm::dot(f.cross, f.cross);
    f.gradient1 = glm::cross(e2, f.cross) / f.area2;
    f.gradient2 = glm::cross(f.cross, e1) / f.area2;
    return f;
}

std::array<dvec3, 3> RayScene::Impl::vertex_normals(const TriangleFrame& f) {
    const auto& normals = f.mesh->mesh->normals;
    const dmat3 covariant = glm::transpose(dmat3(f.object_from_world));
    return {covariant * dvec3(normals[f.corners.x]), covariant * dvec3(normals[f.corners.y]),
            covariant * dvec3(normals[f.corners.z])};
}

SurfacePoint RayScene::Impl::mesh_surface(const HitKey& key, const dvec3& o, const dvec3& d,
                                          double time) const {
    const TriangleFrame f = triangle(key, time);
    SurfacePoint s;
    s.object = f.object;
    s.t = glm::dot(f.a - o, f.cross) / glm::dot(d, f.cross);
    s.position = o + s.t * d;
    const dvec3 from_a = s.position - f.a;
    const double b1 = glm::dot(from_a, f.gradient1), b2 = glm::dot(from_a, f.gradient2), b0 = 1 - b1 - b2;
    // A mirroring transform reverses the winding of triangles, but not which side of the mesh is outside.
    s.geometric_normal = s.normal = (mirrored[f.object] ? -1 : 1) / std::sqrt(f.area2) * f.cross;
    if (!f.mesh->mesh->normals.empty()) {
        const auto n = vertex_normals(f);
        const dvec3 sum = b0 * n[0] + b1 * n[1] + b2 * n[2];
        const double length = glm::length(sum);
        if (length > 0) {
            s.normal = sum / length;
            // If the winding and the vertex normals disagree about which side is outside, the vertex normals
            // decide.
            if (glm::dot(s.normal, s.geometric_normal) < 0) s.geometric_normal = -s.geometric_normal;
        }
    }
    if (const auto& colours = f.mesh->mesh->colours; !colours.empty()) {
        s.colour = static_cast<float>(b0) * colours[f.corners.x] +
                   static_cast<float>(b1) * colours[f.corners.y] +
                   static_cast<float>(b2) * colours[f.corners.z];
    }
    if (textured(s.object)) {
        s.object_position = dvec3(f.object_from_world * glm::dvec4(s.position, 1));
        const auto& uv = f.mesh->mesh->uvs;
        if (!uv.empty()) {
            s.uv = b0 * glm::dvec2(uv[f.corners.x]) + b1 * glm::dvec2(uv[f.corners.y]) +
                   b2 * glm::dvec2(uv[f.corners.z]);
        }
    }
    return s;
}

dmat3 RayScene::Impl::shape_operator(const HitKey& key, const SurfacePoint& at) const {
    const dmat3 across = dmat3(1) - glm::outerProduct(at.normal, at.normal);
    const Entry& entry = entries[key.instance == HitKey::none ? key.geometry : key.instance];
    if (entry.kind == Kind::spheres) return across / spheres.exact_radius[key.primitive];
    if (entry.kind == Kind::analytic) {
        // Returns the derivative of the surface normal with respect to position, in 1/m. In the shape's own
        // frame, it is local_shape_operator. Positions are mapped to this frame by `linear`, and normals back
        // by its transpose. The division and `across` keep the normal at unit length.
        const AnalyticSet::Item& item = analytic.items[key.primitive];
        const dmat3 linear(item.local_from_world);
        const dvec3 local(item.local_from_world * glm::dvec4(at.position, 1));
        return across * glm::transpose(linear) * local_shape_operator(item.shape, at.part, local) * linear /
               glm::length(glm::transpose(linear) * local_normal(item.shape, at.part, local));
    }
    const TriangleFrame f = triangle(key, 0);
    if (f.mesh->mesh->normals.empty()) return dmat3(0);
    const auto n = vertex_normals(f);
    const dvec3 from_a = at.position - f.a;
    const double b1 = glm::dot(from_a, f.gradient1), b2 = glm::dot(from_a, f.gradient2);
    const double length = glm::length((1 - b1 - b2) * n[0] + b1 * n[1] + b2 * n[2]);
    if (!(length > 0)) return dmat3(0);
    return across *
           (glm::outerProduct(n[1] - n[0], f.gradient1) + glm::outerProduct(n[2] - n[0], f.gradient2)) /
           length;
}

SurfacePoint RayScene::surface(const HitKey& key, const dvec3& o, const dvec3& d, double t,
                               double time) const {
    const Impl::Entry& entry = impl_->entries[key.instance == HitKey::none ? key.geometry : key.instance];
    switch (entry.kind) {
        case Impl::Kind::spheres:
            return impl_->sphere_surface(key.primitive, o, d, t);
        case Impl::Kind::analytic:
            return impl_->analytic_surface(impl_->analytic.items[key.primitive], o, d, t, true);
        case Impl::Kind::moving:
            return impl_->moving_surface(key.primitive, o, d, t, time, true);
        default:
            return impl_->mesh_surface(key, o, d, time);
    }
}

SurfacePoint RayScene::texture_point(const HitKey& key, const dvec3& o, const dvec3& d, double t,
                                     double time) const {
    const Impl::Entry& entry = impl_->entries[key.instance == HitKey::none ? key.geometry : key.instance];
    if (entry.kind == Impl::Kind::analytic)
        return impl_->analytic_surface(impl_->analytic.items[key.primitive], o, d, t, false);
    if (entry.kind == Impl::Kind::moving) return impl_->moving_surface(key.primitive, o, d, t, time, false);
    return surface(key, o, d, t, time);
}

std::uint32_t RayScene::object(const HitKey& key) const {
    const std::uint32_t top = key.instance == HitKey::none ? key.geometry : key.instance;
    switch (impl_->entries[top].kind) {
        case Impl::Kind::spheres:
            return impl_->spheres.object[key.primitive];
        case Impl::Kind::analytic:
            return impl_->analytic.items[key.primitive].object;
        case Impl::Kind::moving:
            return impl_->moving.items[key.primitive].object;
        default:
            return impl_->object_of_geometry[top];
    }
}

dmat3 RayScene::shape_operator(const HitKey& key, const SurfacePoint& at) const {
    return impl_->shape_operator(key, at);
}

}  // namespace postlens
