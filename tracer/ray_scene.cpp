#include "tracer/ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <embree3/rtcore.h>
#include <limits>
#include <map>

#include "core/error.h"
#include "core/progress.h"
#include "core/threads.h"
#include "tracer/analytic_shape.h"
#include "tracer/ray_scene_geometry.h"
#include "tracer/shape_bounds.h"

namespace postlens {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

void check(RTCDevice device, const char* doing) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_CANCELLED) throw_if_interrupted();
    if (error == RTC_ERROR_OUT_OF_MEMORY) fail(ExitCode::out_of_memory, "not enough memory for {}", doing);
    fail(ExitCode::invalid_input, "Embree failed while {} (error {})", doing, static_cast<int>(error));
}

bool uniform_scale(const dmat4& m) {
    const dvec3 a(m[0]), b(m[1]), c(m[2]);
    const double aa = glm::dot(a, a), tolerance = 1e-12 * aa;
    return std::abs(aa - glm::dot(b, b)) <= tolerance && std::abs(aa - glm::dot(c, c)) <= tolerance &&
           std::abs(glm::dot(a, b)) <= tolerance && std::abs(glm::dot(a, c)) <= tolerance &&
           std::abs(glm::dot(b, c)) <= tolerance;
}

ObjectShadow shadow_of(const Scene& scene, const Object& object) {
    const Material& m = scene.materials[object.material];
    ObjectShadow s;
    s.casts = object.casts_shadows;
    s.transmits = m.transmission != dvec3(0);
    for (int c = 0; c < 3; ++c)
        s.log_transmission[static_cast<std::size_t>(c)] = fixed_log(m.transmission[c]);
    return s;
}

// The triangle a ray met: what `surface` needs, from the mesh as Embree has it.
struct MeshGeometry {
    std::shared_ptr<const Mesh> mesh;
    std::vector<glm::vec3> positions;  // as Embree has them: world space if baked, else object space
    std::vector<glm::uvec3> triangles;
    std::uint32_t object = 0;  // of a baked mesh
    RTCScene scene = nullptr;  // of a shared one
};
// One triangle in world space, with the gradients of its barycentric coordinates b1 and b2 over its plane.
struct TriangleFrame {
    const MeshGeometry* mesh;
    std::uint32_t object;
    glm::uvec3 corners;
    dvec3 a, cross, gradient1, gradient2;
    double area2;
};
struct InstanceGeometry {
    std::uint32_t object = 0;
    std::size_t mesh = 0;
    dmat4 world_from_object{1};
};

}  // namespace

void RayBatch::grow() {
    const std::size_t capacity = std::max<std::size_t>(256, ox.size() * 2);
    for (auto* v : {&ox, &oy, &oz, &dx, &dy, &dz, &t_far, &t}) v->resize(capacity);
    source.resize(capacity);
    for (auto* v : {&hit_geometry, &hit_primitive, &hit_instance}) v->resize(capacity);
    transmittance.resize(capacity);
}

struct RayScene::Impl {
    explicit Impl(const Scene& of) : scene(&of), device(rtcNewDevice(nullptr)) {
        if (device == nullptr) fail(ExitCode::out_of_memory, "Embree does not start");
    }
    ~Impl() {
        for (RTCScene s : mesh_scenes) rtcReleaseScene(s);
        if (top != nullptr) rtcReleaseScene(top);
        rtcReleaseDevice(device);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    Impl(Impl&&) = delete;
    Impl& operator=(Impl&&) = delete;

    const Scene* scene;
    double time_s = 0;
    RTCDevice device;
    RTCScene top = nullptr;
    std::vector<RTCScene> mesh_scenes;

    SphereSet spheres;
    AnalyticSet analytic;
    std::vector<MeshGeometry> meshes;
    std::vector<InstanceGeometry> instances;
    std::vector<dmat4> object_from_world;  // per object
    std::vector<bool> mirrored;            // per object
    std::vector<ObjectShadow> shadows;     // per object
    bool all_opaque = true;                // no object lets light through

    enum class Kind { spheres, analytic, mesh, instance };
    struct Entry {
        Kind kind = Kind::spheres;
        std::size_t index = 0;
    };
    std::vector<Entry> entries;                     // by geometry id of the top scene
    std::vector<std::uint32_t> object_of_geometry;  // the same; meshes and instances

    void attach(RTCGeometry geometry, const Entry& entry, std::uint32_t object) {
        rtcCommitGeometry(geometry);
        const unsigned id = rtcAttachGeometry(top, geometry);
        rtcReleaseGeometry(geometry);
        entries.resize(std::max<std::size_t>(entries.size(), id + 1));
        object_of_geometry.resize(entries.size());
        entries[id] = entry;
        object_of_geometry[id] = object;
    }

    void commit(RTCScene s) const {
        rtcSetSceneBuildQuality(s, RTC_BUILD_QUALITY_MEDIUM);
        // Without this flag Embree never calls a query's own filter.
        rtcSetSceneFlags(s, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
        rtcSetSceneProgressMonitorFunction(
            s, [](void*, double) { return !interrupted(); }, nullptr);
        const auto build = [&] { rtcCommitScene(s); };
        if (tbb::task_arena* arena = current_arena()) {
            arena->execute(build);
        } else {
            build();
        }
        throw_if_interrupted();
        check(device, "building the ray acceleration structure");
    }

    [[nodiscard]] RTCGeometry triangles_of(const MeshGeometry& mesh) const {
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                          mesh.positions.size());
        void* i = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                          mesh.triangles.size());
        check(device, "storing a mesh");
        std::memcpy(v, mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
        std::memcpy(i, mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
        return g;
    }

    void add_analytic(const PlacedShape& placed, const dmat4& world_from_object, std::uint32_t object);
    void add_mesh(const std::shared_ptr<const Mesh>& mesh, const dmat4& world_from_object,
                  std::uint32_t object, bool share, std::map<const Mesh*, std::size_t>& shared);
    void add_objects();

    [[nodiscard]] SurfacePoint sphere_surface(std::uint32_t primitive, const dvec3& o, const dvec3& d,
                                              double t) const;
    [[nodiscard]] SurfacePoint analytic_surface(const AnalyticSet::Item& item, const dvec3& o, const dvec3& d,
                                                double t) const;
    [[nodiscard]] TriangleFrame triangle(const HitKey& key) const;
    [[nodiscard]] std::array<dvec3, 3> vertex_normals(const TriangleFrame& f) const;
    [[nodiscard]] SurfacePoint mesh_surface(const HitKey& key, const dvec3& o, const dvec3& d) const;
    [[nodiscard]] dmat3 shape_operator(const HitKey& key, const SurfacePoint& at) const;
    [[nodiscard]] bool textured(std::uint32_t object) const {
        const Material& m = scene->materials[scene->objects[object].material];
        return m.colour_texture != nullptr || m.emission_texture != nullptr;
    }
};

void RayScene::Impl::add_analytic(const PlacedShape& placed, const dmat4& world_from_object,
                                  std::uint32_t object) {
    const dmat4 world_from_local = world_from_object * placed.object_from_local;
    if (placed.shape.kind == AnalyticShape::Kind::sphere && uniform_scale(world_from_local)) {
        spheres.add(dvec3(world_from_local[3]), glm::length(dvec3(world_from_local[0])), object);
        return;
    }
    AnalyticSet::Item item;
    item.shape = placed.shape;
    item.object = object;
    item.object_from_local = placed.object_from_local;
    item.local_from_world = glm::inverse(world_from_local);
    item.linear = glm::mat3(dmat3(item.local_from_world));
    item.pivot = glm::vec3(dvec3(world_from_local[3]));
    item.shift = glm::vec3(dvec3(item.local_from_world * glm::dvec4(dvec3(item.pivot), 1)));
    analytic.items.push_back(item);
    const Bounds bounds = shape_bounds(scene->objects[object].shape, world_from_object);
    analytic.lower.emplace_back(bounds.min);
    analytic.upper.emplace_back(bounds.max);
}

void RayScene::Impl::add_mesh(const std::shared_ptr<const Mesh>& mesh, const dmat4& world_from_object,
                              std::uint32_t object, bool share, std::map<const Mesh*, std::size_t>& shared) {
    if (!share) {
        MeshGeometry g{mesh, mesh->positions, mesh->triangles, object};
        for (glm::vec3& p : g.positions) p = glm::vec3(dvec3(world_from_object * glm::dvec4(dvec3(p), 1)));
        attach(triangles_of(g), {Kind::mesh, meshes.size()}, object);
        meshes.push_back(std::move(g));
        return;
    }
    if (!shared.contains(mesh.get())) {
        shared[mesh.get()] = meshes.size();
        meshes.push_back({mesh, mesh->positions, mesh->triangles, object});
        RTCScene s = rtcNewScene(device);
        mesh_scenes.push_back(s);
        meshes.back().scene = s;
        RTCGeometry g = triangles_of(meshes.back());
        rtcCommitGeometry(g);
        rtcAttachGeometry(s, g);
        rtcReleaseGeometry(g);
        commit(s);
    }
    const std::size_t index = shared[mesh.get()];
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, static_cast<RTCScene>(meshes[index].scene));
    const glm::mat4x3 affine(world_from_object);
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &affine);
    attach(g, {Kind::instance, instances.size()}, object);
    instances.push_back({object, index, world_from_object});
}

void RayScene::Impl::add_objects() {
    std::map<const Mesh*, int> uses;
    for (const Object& o : scene->objects) {
        if (const auto* m = std::get_if<std::shared_ptr<const Mesh>>(&o.shape)) ++uses[m->get()];
    }
    std::map<const Mesh*, std::size_t> shared;
    for (std::uint32_t i = 0; i < scene->objects.size(); ++i) {
        const Object& object = scene->objects[i];
        const dmat4 world_from_object = object.keys.empty()
                                            ? object.world_from_object
                                            : transform_at(object.keys, time_s) * object.motion_base;
        object_from_world.push_back(glm::inverse(world_from_object));
        mirrored.push_back(glm::determinant(dmat3(world_from_object)) < 0);
        shadows.push_back(shadow_of(*scene, object));
        all_opaque = all_opaque && shadows.back().casts && !shadows.back().transmits;
        if (const auto placed = place_shape(object.shape)) {
            add_analytic(*placed, world_from_object, i);
            continue;
        }
        const auto& mesh = std::get<std::shared_ptr<const Mesh>>(object.shape);
        // Sharing saves memory from a few hundred triangles on; below that one flat structure is faster to
        // walk.
        constexpr std::size_t smallest_shared = 256;
        add_mesh(mesh, world_from_object, i,
                 uses[mesh.get()] > 1 && mesh->triangles.size() >= smallest_shared, shared);
    }
    if (!spheres.radius.empty()) attach(sphere_geometry(device, spheres), {Kind::spheres, 0}, 0);
    if (!analytic.items.empty()) attach(analytic_geometry(device, analytic), {Kind::analytic, 0}, 0);
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
        s.uv = local_geometry({}, 0, (s.object_position - shape.centre) / shape.radius).uv;
    }
    return s;
}

SurfacePoint RayScene::Impl::analytic_surface(const AnalyticSet::Item& item, const dvec3& o, const dvec3& d,
                                              double t) const {
    const dmat3 linear(item.local_from_world);
    const dvec3 lo(item.local_from_world * glm::dvec4(o, 1));
    const dvec3 ld = linear * d;
    const Crossings<double> found = crossings<double>(item.shape, lo, ld);
    SurfacePoint s;
    s.object = item.object;
    s.t = t;  // kept where float saw a silhouette that double just misses
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < found.count; ++k) {
        if (std::abs(found.t[k] - t) >= best) continue;
        best = std::abs(found.t[k] - t);
        s.t = found.t[k];
        s.part = found.part[k];
    }
    s.position = o + s.t * d;
    const dvec3 local = lo + s.t * ld;
    const LocalGeometry g = local_geometry(item.shape, s.part, local);
    s.geometric_normal = s.normal =
        glm::normalize(glm::transpose(linear) * g.normal);  // normals go over as covectors
    s.uv = g.uv;
    s.object_position = dvec3(item.object_from_local * glm::dvec4(local, 1));
    return s;
}

TriangleFrame RayScene::Impl::triangle(const HitKey& key) const {
    TriangleFrame f{};
    const bool instanced = key.instance != HitKey::none;
    const Entry& entry = entries[instanced ? key.instance : key.geometry];
    f.mesh = &meshes[instanced ? instances[entry.index].mesh : entry.index];
    f.object = instanced ? instances[entry.index].object : f.mesh->object;
    f.corners = f.mesh->triangles[key.primitive];
    const auto world = [&](std::uint32_t i) {
        const dvec3 p(f.mesh->positions[i]);
        return instanced ? dvec3(instances[entry.index].world_from_object * glm::dvec4(p, 1)) : p;
    };
    f.a = world(f.corners.x);
    const dvec3 e1 = world(f.corners.y) - f.a, e2 = world(f.corners.z) - f.a;
    f.cross = glm::cross(e1, e2);
    f.area2 = glm::dot(f.cross, f.cross);
    f.gradient1 = glm::cross(e2, f.cross) / f.area2;
    f.gradient2 = glm::cross(f.cross, e1) / f.area2;
    return f;
}

std::array<dvec3, 3> RayScene::Impl::vertex_normals(const TriangleFrame& f) const {
    const auto& normals = f.mesh->mesh->normals;
    const dmat3 covariant = glm::transpose(dmat3(object_from_world[f.object]));
    return {covariant * dvec3(normals[f.corners.x]), covariant * dvec3(normals[f.corners.y]),
            covariant * dvec3(normals[f.corners.z])};
}

SurfacePoint RayScene::Impl::mesh_surface(const HitKey& key, const dvec3& o, const dvec3& d) const {
    const TriangleFrame f = triangle(key);
    SurfacePoint s;
    s.object = f.object;
    s.t = glm::dot(f.a - o, f.cross) / glm::dot(d, f.cross);
    s.position = o + s.t * d;
    const dvec3 from_a = s.position - f.a;
    const double b1 = glm::dot(from_a, f.gradient1), b2 = glm::dot(from_a, f.gradient2), b0 = 1 - b1 - b2;
    // A mirroring transform turns the winding over; the outside stays where the mesh has it.
    s.geometric_normal = s.normal = (mirrored[f.object] ? -1 : 1) / std::sqrt(f.area2) * f.cross;
    if (!f.mesh->mesh->normals.empty()) {
        const auto n = vertex_normals(f);
        const dvec3 sum = b0 * n[0] + b1 * n[1] + b2 * n[2];
        const double length = glm::length(sum);
        if (length > 0) {
            s.normal = sum / length;
            // Vertex normals say which side is out only as far as the winding agrees.
            if (glm::dot(s.normal, s.geometric_normal) < 0) s.geometric_normal = -s.geometric_normal;
        }
    }
    if (textured(s.object)) {
        s.object_position = dvec3(object_from_world[s.object] * glm::dvec4(s.position, 1));
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
        // d(normalised covector) along moves in the world.
        const AnalyticSet::Item& item = analytic.items[key.primitive];
        const dmat3 linear(item.local_from_world);
        const dvec3 local(item.local_from_world * glm::dvec4(at.position, 1));
        const LocalGeometry g = local_geometry(item.shape, at.part, local);
        return across * glm::transpose(linear) * g.shape_operator * linear /
               glm::length(glm::transpose(linear) * g.normal);
    }
    const TriangleFrame f = triangle(key);
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

RayScene::RayScene(const Scene& scene, double time_s) : impl_(std::make_unique<Impl>(scene)) {
    impl_->time_s = time_s;
    impl_->top = rtcNewScene(impl_->device);
    impl_->add_objects();
    impl_->commit(impl_->top);
}

RayScene::~RayScene() = default;

const Scene& RayScene::scene() const {
    return *impl_->scene;
}

double RayScene::time_s() const {
    return impl_->time_s;
}

void* RayScene::native_handle() const {
    return impl_->top;
}

double RayScene::offset(const dvec3& p) {
    // 2^-18 of the coordinates: 64 float roundings, enough for Embree's triangle test on a neighbour.
    return 0x1p-18 *
           std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), std::numeric_limits<double>::min()});
}

namespace {

// Copies 16 rays into Embree's packet; lanes past the end stay off.
template <typename Packet>
void load(const RayBatch& rays, std::size_t first, Packet& p, int* valid) {
    constexpr std::size_t n = RayBatch::group;
    const std::size_t left = std::min(n, static_cast<std::size_t>(rays.count) - first);
    const auto copy = [&](float* to, const std::vector<float>& from) {
        // Capacity is a multiple of 16, so a whole group may always be read.
        std::memcpy(to, from.data() + first, n * sizeof(float));
    };
    copy(p.org_x, rays.ox);
    copy(p.org_y, rays.oy);
    copy(p.org_z, rays.oz);
    copy(p.dir_x, rays.dx);
    copy(p.dir_y, rays.dy);
    copy(p.dir_z, rays.dz);
    copy(p.tfar, rays.t_far);
    for (std::size_t i = 0; i < n; ++i) {
        p.tnear[i] = 0;
        p.time[i] = 0;
        p.mask[i] = 0xFFFFFFFFU;
        p.flags[i] = 0;
        p.id[i] = static_cast<unsigned>(first + i);
        // Embree stops the program on a ray that is not finite: such a ray hits nothing instead.
        const float most = std::max({std::abs(p.org_x[i]), std::abs(p.org_y[i]), std::abs(p.org_z[i]),
                                     std::abs(p.dir_x[i]), std::abs(p.dir_y[i]), std::abs(p.dir_z[i])});
        const float sum = p.org_x[i] + p.org_y[i] + p.org_z[i] + p.dir_x[i] + p.dir_y[i] + p.dir_z[i];
        valid[i] = i < left && most < 1e18F && sum == sum ? -1 : 0;
    }
}

}  // namespace

void RayScene::intersect(RayBatch& rays, bool coherent) const {
    RayContext context;
    rtcInitIntersectContext(&context.base);
    if (coherent) context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (rays.has_sources) {
        context.sources = rays.source.data();
        context.base.filter = filter_source;
    }
    constexpr std::size_t n = RayBatch::group;
    RTCRayHit16 p;  // NOLINT(cppcoreguidelines-pro-type-member-init): `load` fills it
    alignas(64) std::array<int, n> valid{};
    for (std::size_t first = 0; first < static_cast<std::size_t>(rays.count); first += n) {
        load(rays, first, p.ray, valid.data());
        for (std::size_t i = 0; i < n; ++i) {
            p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid.data(), impl_->top, &context.base, &p);
        // Capacity is a multiple of 16: a whole group may always be written.
        std::memcpy(rays.hit_geometry.data() + first, p.hit.geomID, sizeof p.hit.geomID);
        std::memcpy(rays.hit_primitive.data() + first, p.hit.primID, sizeof p.hit.primID);
        std::memcpy(rays.hit_instance.data() + first, p.hit.instID[0], sizeof p.hit.instID[0]);
        std::memcpy(rays.t.data() + first, p.ray.tfar, sizeof p.ray.tfar);
    }
}

void RayScene::occlude(RayBatch& rays) const {
    RayContext context;
    // Always as incoherent: Embree 3.13's coherent occlusion of packets whose directions differ in sign never
    // ends.
    rtcInitIntersectContext(&context.base);
    context.shadows = impl_->shadows.data();
    context.object_of_geometry = impl_->object_of_geometry.data();
    if (rays.has_sources) context.sources = rays.source.data();
    if (rays.has_sources || !impl_->all_opaque)
        context.base.filter = impl_->all_opaque ? filter_source : filter_shadow;
    constexpr std::size_t n = RayBatch::group;
    const auto count = static_cast<std::size_t>(rays.count);
    std::vector<std::array<std::int64_t, 3>> logs;
    if (!impl_->all_opaque) {
        logs.assign((count + n - 1) / n * n, {});
        context.log_transmission = logs.data();
    }
    RTCRay16 p;  // NOLINT(cppcoreguidelines-pro-type-member-init): `load` fills it
    alignas(64) std::array<int, n> valid{};
    for (std::size_t first = 0; first < count; first += n) {
        load(rays, first, p, valid.data());
        rtcOccluded16(valid.data(), impl_->top, &context.base, &p);
        for (std::size_t i = 0; i < n && first + i < count; ++i) {
            dvec3 passed(p.tfar[i] < 0 ? 0.0 : 1.0);
            if (passed.x > 0 && !logs.empty()) {
                const auto& sum = logs[first + i];
                if ((sum[0] | sum[1] | sum[2]) != 0) {
                    passed = {from_fixed_log(sum[0]), from_fixed_log(sum[1]), from_fixed_log(sum[2])};
                }
            }
            rays.transmittance[first + i] = passed;
        }
    }
}

SurfacePoint RayScene::surface(const HitKey& key, const dvec3& o, const dvec3& d, double t) const {
    const Impl::Entry& entry = impl_->entries[key.instance == HitKey::none ? key.geometry : key.instance];
    if (entry.kind == Impl::Kind::spheres) return impl_->sphere_surface(key.primitive, o, d, t);
    if (entry.kind == Impl::Kind::analytic)
        return impl_->analytic_surface(impl_->analytic.items[key.primitive], o, d, t);
    return impl_->mesh_surface(key, o, d);
}

dmat3 RayScene::shape_operator(const HitKey& key, const SurfacePoint& at) const {
    return impl_->shape_operator(key, at);
}

}  // namespace postlens
