// Passes the still and moving objects of a scene to Embree, which builds its acceleration structures.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/job.h"
#include "scene/object_pose.h"
#include "scene/shape_bounds.h"
#include "tracer/intersection/ray_scene_impl.h"

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

}  // namespace

RayScene::Impl::Impl(const Scene& of, const TimeSpan& over)
    : scene(&of), span(over), device(rtcNewDevice(nullptr)) {
    if (device == nullptr) fail(ExitCode::out_of_memory, "Embree does not start");
}

RayScene::Impl::~Impl() {
    for (RTCScene s : mesh_scenes) rtcReleaseScene(s);
    if (top != nullptr) rtcReleaseScene(top);
    rtcReleaseDevice(device);
}

void RayScene::Impl::attach(RTCGeometry geometry, const Entry& entry, std::uint32_t object) {
    rtcCommitGeometry(geometry);
    const unsigned id = rtcAttachGeometry(top, geometry);
    rtcReleaseGeometry(geometry);
    entries.resize(std::max<std::size_t>(entries.size(), id + 1));
    object_of_geometry.resize(entries.size());
    lifetimes.resize(entries.size());
    entries[id] = entry;
    object_of_geometry[id] = object;
}

void RayScene::Impl::commit(RTCScene s) const {
    rtcSetSceneBuildQuality(s, RTC_BUILD_QUALITY_MEDIUM);
    // Without this flag, Embree does not call filter functions that are set per query.
    rtcSetSceneFlags(s, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneProgressMonitorFunction(
        s, [](void* job, double) { return !static_cast<const Job*>(job)->cancelled(); }, &Job::current());
    Job::current().run([s] { rtcCommitScene(s); });
    throw_if_interrupted();
    check(device, "building the ray acceleration structure");
}

RTCGeometry RayScene::Impl::triangles_of(const MeshGeometry& mesh) const {
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
    if (item.shape.flat())
        item.flat_normal = glm::normalize(local_normal(item.shape, 0, {}) * dmat3(item.local_from_world));
    item.linear = glm::mat3(dmat3(item.local_from_world));
    item.pivot = glm::vec3(dvec3(world_from_local[3]));
    item.shift = glm::vec3(dvec3(item.local_from_world * glm::dvec4(dvec3(item.pivot), 1)));
    analytic.items.push_back(item);
    const Bounds bounds = shape_bounds(scene->objects[object].shape, world_from_object);
    analytic.lower.emplace_back(bounds.min);
    analytic.upper.emplace_back(bounds.max);
}

void RayScene::Impl::add_baked(const std::shared_ptr<const Mesh>& mesh, const dmat4& world_from_object,
                               std::uint32_t object) {
    MeshGeometry g{mesh, mesh->positions, mesh->triangles, object};
    for (glm::vec3& p : g.positions) p = glm::vec3(dvec3(world_from_object * glm::dvec4(dvec3(p), 1)));
    attach(triangles_of(g), {Kind::mesh, meshes.size()}, object);
    meshes.push_back(std::move(g));
}

std::size_t RayScene::Impl::shared_mesh(const std::shared_ptr<const Mesh>& mesh, std::uint32_t object) {
    const auto [at, added] = shared_meshes.try_emplace(mesh.get(), meshes.size());
    if (!added) return at->second;
    meshes.push_back({mesh, mesh->positions, mesh->triangles, object});
    RTCScene s = rtcNewScene(device);
    mesh_scenes.push_back(s);
    meshes.back().scene = s;
    RTCGeometry g = triangles_of(meshes.back());
    rtcCommitGeometry(g);
    rtcAttachGeometry(s, g);
    rtcReleaseGeometry(g);
    commit(s);
    return at->second;
}

void RayScene::Impl::add_instance(InstanceGeometry instance, float begin, float end) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, meshes[instance.mesh].scene);
    const auto steps = static_cast<unsigned>(instance.world_from_object.size());
    rtcSetGeometryTimeStepCount(g, steps);
    if (steps > 1) rtcSetGeometryTimeRange(g, begin, end);
    for (unsigned i = 0; i < steps; ++i) {
        const glm::mat4x3 affine(instance.world_from_object[i]);
        rtcSetGeometryTransform(g, i, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &affine);
    }
    const std::uint32_t object = instance.object;
    attach(g, {Kind::instance, instances.size()}, object);
    instances.push_back(std::move(instance));
    if (begin > 0) lifetimes.back().begin = begin;
    if (end < 1) lifetimes.back().end = end;
    any_cut = any_cut || begin > 0 || end < 1;
}

// Adds a moving mesh to the Embree scene. One Embree instance is added for each interval between two
// keyframes, because the motion may change suddenly at a keyframe. A single instance with equal time steps
// would smooth these changes.
void RayScene::Impl::add_moving_mesh(const std::shared_ptr<const Mesh>& mesh, const MotionPath& path,
                                     std::uint32_t object, const MotionAccuracy& accuracy) {
    Bounds box;
    for (const glm::vec3& p : mesh->positions) box.add(dvec3(p));
    const std::size_t shared = shared_mesh(mesh, object);
    const std::vector<double> times = path.intervals(span.open_s, span.close_s);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        MotionSteps steps =
            motion_steps(path, scene->objects[object].motion_base, box, times[i], times[i + 1], accuracy);
        motion_error_px = std::max(motion_error_px, steps.error_px);
        const auto share = [&](double time_s) {
            return static_cast<float>((time_s - span.open_s) / (span.close_s - span.open_s));
        };
        const float begin = share(times[i]), end = i + 2 == times.size() ? 1.0F : share(times[i + 1]);
        InstanceGeometry g{object, shared, std::move(steps.world_from_object), static_cast<double>(begin), 0};
        g.per_step =
            (static_cast<double>(end) - g.begin) / static_cast<double>(g.world_from_object.size() - 1);
        add_instance(std::move(g), begin, end);
    }
}

void RayScene::Impl::add_moving(const MotionPath& path, std::uint32_t object,
                                const MotionAccuracy& accuracy) {
    any_moves = true;
    const Object& o = scene->objects[object];
    if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&o.shape)) {
        add_moving_mesh(*mesh, path, object, accuracy);
        return;
    }
    const PlacedShape placed = *place_shape(o.shape);
    moving.items.push_back({placed.shape, glm::inverse(o.motion_base * placed.object_from_local),
                            placed.object_from_local, object, moving.paths.size()});
    moving.paths.push_back(path);
}

void RayScene::Impl::bound_moving() {
    moving.span = span;
    // Largest number of time steps for the motion of an object. Embree interpolates the object's bounding box
    // between the steps. With 32 steps, the boxes are tight. More steps would only enlarge Embree's hierarchy
    // of boxes.
    constexpr int most_steps = 32;
    int steps = 1;
    for (const MovingSet::Item& item : moving.items) {
        const Object& o = scene->objects[item.object];
        double way = 0, size = 0;
        dvec3 before(0);
        for (int i = 0; i <= most_steps; ++i) {
            const Bounds b = shape_bounds(
                o.shape, moving.paths[item.path].at(span.at(static_cast<double>(i) / most_steps)).matrix() *
                             o.motion_base);
            const dvec3 middle = 0.5 * (b.min + b.max);
            if (i > 0) way += glm::length(middle - before);
            before = middle;
            size = std::max(size, glm::length(b.max - b.min));
        }
        const double wanted = way / size;  // NaN for infinite shapes
        steps = std::max(steps, wanted < most_steps    ? static_cast<int>(std::ceil(wanted))
                                : wanted >= most_steps ? most_steps
                                                       : 1);
    }
    moving.steps = steps;
    for (const MovingSet::Item& item : moving.items) {
        const Object& o = scene->objects[item.object];
        for (const Bounds& b : moving_bounds(moving.paths[item.path], o.shape, o.motion_base, span.open_s,
                                             span.close_s, steps)) {
            moving.lower.emplace_back(b.min);
            moving.upper.emplace_back(b.max);
        }
    }
}

RayScene::Impl::TextureUse RayScene::Impl::texture_use(const Material& m) {
    TextureUse use = TextureUse::none;
    for (const Texture* texture : {m.colour_texture.get(), m.emission_texture.get()}) {
        if (texture != nullptr)
            use = std::max(use, texture->uses_uv() ? TextureUse::uv : TextureUse::position);
    }
    return use;
}

void RayScene::Impl::add_objects(const MotionAccuracy& accuracy) {
    std::map<const Mesh*, int> uses;
    for (const Object& o : scene->objects) {
        if (const auto* m = std::get_if<std::shared_ptr<const Mesh>>(&o.shape)) ++uses[m->get()];
    }
    for (std::uint32_t i = 0; i < scene->objects.size(); ++i) {
        const Object& object = scene->objects[i];
        const dmat4 world_from_object = world_at(object, span.open_s);
        object_from_world.push_back(glm::inverse(world_from_object));
        mirrored.push_back(glm::determinant(dmat3(world_from_object)) < 0);
        shadows.push_back(shadow_of(*scene, object));
        texture_uses.push_back(texture_use(scene->materials[object.material]));
        all_opaque = all_opaque && shadows.back().casts && !shadows.back().transmits;
        if (!object.keys.empty()) {
            const MotionPath path(object.keys);
            if (path.moves(span.open_s, span.close_s)) {
                add_moving(path, i, accuracy);
                continue;
            }
        }
        if (const auto placed = place_shape(object.shape)) {
            add_analytic(*placed, world_from_object, i);
            continue;
        }
        const auto& mesh = std::get<std::shared_ptr<const Mesh>>(object.shape);
        // Instances of a mesh of 256 or more triangles share one acceleration structure, to save memory.
        // Smaller meshes are copied into one common structure, which rays traverse faster.
        constexpr std::size_t smallest_shared = 256;
        if (uses[mesh.get()] > 1 && mesh->triangles.size() >= smallest_shared) {
            add_instance({i, shared_mesh(mesh, i), {world_from_object}, 0, 0}, 0, 1);
        } else {
            add_baked(mesh, world_from_object, i);
        }
    }
    if (!spheres.radius.empty()) attach(sphere_geometry(device, spheres), {Kind::spheres, 0}, 0);
    if (!analytic.items.empty()) attach(analytic_geometry(device, analytic), {Kind::analytic, 0}, 0);
    if (!moving.items.empty()) {
        bound_moving();
        attach(moving_geometry(device, moving), {Kind::moving, 0}, 0);
    }
}

RayScene::RayScene(const Scene& scene, double time_s)
    : RayScene(scene, TimeSpan{time_s, time_s}, MotionAccuracy{}) {}

RayScene::RayScene(const Scene& scene, const TimeSpan& span, const MotionAccuracy& accuracy)
    : impl_(std::make_unique<Impl>(scene, span)) {
    impl_->top = rtcNewScene(impl_->device);
    impl_->add_objects(accuracy);
    impl_->commit(impl_->top);
}

}  // namespace postlens
