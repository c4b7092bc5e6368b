// The implementation of RayScene. Only the files ray_scene*.cpp include this header.
#pragma once

#include <array>
#include <cstdint>
#include <embree3/rtcore.h>
#include <map>
#include <memory>
#include <vector>

#include "tracer/intersection/analytic_shape.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/intersection/ray_scene_geometry.h"

namespace postlens {

// A mesh as it is passed to Embree. Exact hit points (RayScene::surface) are computed from the same data.
struct MeshGeometry {
    std::shared_ptr<const Mesh> mesh;
    std::vector<glm::vec3> positions;  // in world space if `baked`, else in object space
    std::vector<glm::uvec3> triangles;
    std::uint32_t object = 0;  // only for a baked mesh
    RTCScene scene = nullptr;  // only for a shared mesh
};

// A triangle in world space, with what is needed to compute exact hit points. `gradient1` and `gradient2` are
// the gradients, with respect to position, of the barycentric coordinates (weights) of the second and the
// third corner.
struct TriangleFrame {
    const MeshGeometry* mesh;
    std::uint32_t object;
    glm::uvec3 corners;
    glm::dvec3 a, cross, gradient1, gradient2;
    double area2;
    glm::dmat4 object_from_world;  // at the ray's time, if `surface` needs it (Impl::triangle)
};

// An Embree instance of a mesh that moves or is shared by several objects.
// A moving mesh has one instance for each interval between keyframes.
struct InstanceGeometry {
    std::uint32_t object = 0;
    std::size_t mesh = 0;
    std::vector<glm::dmat4> world_from_object;  // one, or one per time step
    double begin = 0, per_step = 0;             // fractions of the time span
    // Returns the mesh's object-to-world transform at a ray's time, interpolated exactly as in Embree, so
    // that it fits Embree's hits.
    [[nodiscard]] glm::dmat4 at(double time) const;
};

struct RayScene::Impl {
    Impl(const Scene& of, const TimeSpan& over);
    ~Impl();
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    Impl(Impl&&) = delete;
    Impl& operator=(Impl&&) = delete;

    const Scene* scene;
    TimeSpan span;
    RTCDevice device;
    RTCScene top = nullptr;
    std::vector<RTCScene> mesh_scenes;

    SphereSet spheres;
    AnalyticSet analytic;
    MovingSet moving;
    bool any_moves = false;
    double motion_error_px = 0;
    std::vector<MeshGeometry> meshes;
    std::vector<InstanceGeometry> instances;
    std::vector<glm::dmat4> object_from_world;  // per object, at the beginning of the shutter interval
    std::vector<bool> mirrored;                 // per object
    std::vector<ObjectShadow> shadows;          // per object
    bool all_opaque = true;                     // every object blocks shadow rays
    enum class TextureUse : std::uint8_t { none, position, uv };
    std::vector<TextureUse> texture_uses;  // per object
    [[nodiscard]] static TextureUse texture_use(const Material& m);

    enum class Kind { spheres, analytic, moving, mesh, instance };
    struct Entry {
        Kind kind = Kind::spheres;
        std::size_t index = 0;
    };
    std::vector<Entry> entries;                     // per geometry id of the top-level scene
    std::vector<std::uint32_t> object_of_geometry;  // per geometry id; valid for meshes and instances
    std::vector<Lifetime> lifetimes;                // per geometry id; valid for instances
    bool any_cut = false;                           // an instance exists only during a part of the time span

    // Building: ray_scene_build.cpp.
    void attach(RTCGeometry geometry, const Entry& entry, std::uint32_t object);
    void commit(RTCScene s) const;
    [[nodiscard]] RTCGeometry triangles_of(const MeshGeometry& mesh) const;
    void add_analytic(const PlacedShape& placed, const glm::dmat4& world_from_object, std::uint32_t object);
    void add_baked(const std::shared_ptr<const Mesh>& mesh, const glm::dmat4& world_from_object,
                   std::uint32_t object);
    [[nodiscard]] std::size_t shared_mesh(const std::shared_ptr<const Mesh>& mesh, std::uint32_t object);
    void add_instance(InstanceGeometry instance, float begin, float end);
    void add_moving_mesh(const std::shared_ptr<const Mesh>& mesh, const MotionPath& path,
                         std::uint32_t object, const MotionAccuracy& accuracy);
    void add_moving(const MotionPath& path, std::uint32_t object, const MotionAccuracy& accuracy);
    void bound_moving();
    void add_objects(const MotionAccuracy& accuracy);
    std::map<const Mesh*, std::size_t> shared_meshes;

    // These functions compute hits in double precision (ray_scene_surface.cpp).
    [[nodiscard]] SurfacePoint sphere_surface(std::uint32_t primitive, const glm::dvec3& o,
                                              const glm::dvec3& d, double t) const;
    // A hit on an analytic shape, in the shape's own frame.
    struct LocalHit {
        glm::dvec3 o, d;  // the ray
        double t = 0;
        int part = 0;
        [[nodiscard]] glm::dvec3 position() const { return o + t * d; }
    };
    static void solve(const AnalyticShape& shape, LocalHit& hit);
    void look_up_texture(const AnalyticShape& shape, const glm::dmat4& object_from_local, const LocalHit& hit,
                         SurfacePoint& out) const;
    template <typename Item, typename Normal>
    [[nodiscard]] SurfacePoint solved_surface(const Item& item, LocalHit& hit, const glm::dvec3& o,
                                              const glm::dvec3& d, bool normals,
                                              const Normal& world_normal) const;
    [[nodiscard]] SurfacePoint analytic_surface(const AnalyticSet::Item& item, const glm::dvec3& o,
                                                const glm::dvec3& d, double t, bool normals) const;
    [[nodiscard]] SurfacePoint moving_surface(std::uint32_t primitive, const glm::dvec3& o,
                                              const glm::dvec3& d, double t, double time, bool normals) const;
    [[nodiscard]] TriangleFrame triangle(const HitKey& key, double time) const;
    [[nodiscard]] static std::array<glm::dvec3, 3> vertex_normals(const TriangleFrame& f);
    [[nodiscard]] SurfacePoint mesh_surface(const HitKey& key, const glm::dvec3& o, const glm::dvec3& d,
                                            double time) const;
    [[nodiscard]] glm::dmat3 shape_operator(const HitKey& key, const SurfacePoint& at) const;
    [[nodiscard]] bool textured(std::uint32_t object) const {
        return texture_uses[object] != TextureUse::none;
    }
    [[nodiscard]] bool wants_uv(std::uint32_t object) const { return texture_uses[object] == TextureUse::uv; }
};

}  // namespace postlens
