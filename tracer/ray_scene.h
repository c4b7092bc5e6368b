// A scene ready for rays, at one instant or over the time that a shutter is open: Embree finds what is hit,
// in float; the hit itself is then solved again in double, so that normals, mirrors and ray differentials are
// exact at any scale.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "tracer/motion_steps.h"
#include "tracer/scene.h"

namespace postlens {

/// When a shutter opens and closes, s; a ray's `time` is its share of the way from one to the other.
struct TimeSpan {
    double open_s = 0, close_s = 0;
    [[nodiscard]] double at(double share) const { return open_s + share * (close_s - open_s); }
};

/// Which primitive was hit. A ray that starts on a surface carries it, so that it does not hit the same point
/// again.
struct HitKey {
    static constexpr std::uint32_t none = 0xFFFFFFFFU;
    std::uint32_t geometry = none, primitive = none, instance = none;
    friend constexpr bool operator==(const HitKey&, const HitKey&) = default;
    [[nodiscard]] bool valid() const { return geometry != none; }
};

/// A batch of rays, structure of arrays, in groups of 16 that should lie close together.
class RayBatch {
  public:
    static constexpr int group = 16;
    int count = 0;  ///< rays in use
    std::vector<float> ox, oy, oz, dx, dy, dz, t_far;
    bool has_sources = false;    ///< false: no ray of the batch leaves a surface
    std::vector<HitKey> source;  ///< the surface each ray leaves
    bool has_times = false;      ///< false: all rays travel at the shutter's opening
    std::vector<float> time;     ///< share of the time span, 0 to 1
    // Results.
    std::vector<std::uint32_t> hit_geometry, hit_primitive, hit_instance;
    std::vector<float> t;  ///< in units of the direction's length
    // Results of `occlude`: what share of the light passes, per channel.
    std::vector<glm::dvec3> transmittance;

    /// What ray i hit; `none` where nothing was.
    [[nodiscard]] HitKey hit(std::size_t i) const {
        return {hit_geometry[i], hit_primitive[i], hit_instance[i]};
    }

    void clear(bool with_sources, bool with_times = false) {
        count = 0;
        has_sources = with_sources;
        has_times = with_times;
    }
    /// Makes room for 16 more rays and returns the index of the first, for a caller that fills the arrays.
    std::size_t add_group() {
        const auto first = static_cast<std::size_t>(count);
        while (first + group > ox.size()) grow();
        count += group;
        return first;
    }
    void add(const glm::dvec3& o, const glm::dvec3& d, float far, const HitKey& from = {}, float at = 0) {
        const auto i = static_cast<std::size_t>(count);
        if (i == ox.size()) grow();
        // All seven converted before any is stored: a store might otherwise change where the next array lies.
        const auto o0 = static_cast<float>(o.x), o1 = static_cast<float>(o.y), o2 = static_cast<float>(o.z);
        const auto d0 = static_cast<float>(d.x), d1 = static_cast<float>(d.y), d2 = static_cast<float>(d.z);
        float *to_ox = ox.data() + i, *to_oy = oy.data() + i, *to_oz = oz.data() + i;
        float *to_dx = dx.data() + i, *to_dy = dy.data() + i, *to_dz = dz.data() + i,
              *to_far = t_far.data() + i;
        *to_ox = o0, *to_oy = o1, *to_oz = o2;
        *to_dx = d0, *to_dy = d1, *to_dz = d2;
        *to_far = far;
        if (has_sources) source[i] = from;
        if (has_times) time[i] = at;
        ++count;
    }

  private:
    void grow();
};

/// The surface at a hit, in world space.
struct SurfacePoint {
    double t = 0;  ///< distance along the (unit) ray, m
    glm::dvec3 position{0};
    glm::dvec3 geometric_normal{0, 0, 1};  ///< unit, outward
    glm::dvec3 normal{0, 0, 1};            ///< unit, outward; interpolated on smooth meshes
    glm::dvec3 object_position{0};         ///< in the object's own space, for textures
    glm::dvec2 uv{0};
    glm::vec3 colour{1};       ///< of the mesh's corners, interpolated; 1 without
    std::uint32_t object = 0;  ///< index into Scene::objects
    int part = 0;              ///< of an analytic shape: face or cap
};

class RayScene {
  public:
    /// The scene at one instant. Keeps a reference to `scene`. Throws Error(interrupted) when the user
    /// interrupts the build.
    RayScene(const Scene& scene, double time_s);
    /// The scene while a shutter is open, every ray at its own instant. Shapes with a formula move by their
    /// true transforms; meshes go linearly from step to step, with as many steps as `accuracy` asks for.
    RayScene(const Scene& scene, const TimeSpan& span, const MotionAccuracy& accuracy);
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;
    RayScene(RayScene&&) = delete;
    RayScene& operator=(RayScene&&) = delete;

    /// Nearest hit of every ray. `coherent`: the rays of a group run nearly side by side.
    void intersect(RayBatch& rays, bool coherent) const;
    /// What share of light passes each ray's segment: opaque surfaces stop it, transmitting ones colour it
    /// once per crossing (Whitted's straight shadow rays).
    void occlude(RayBatch& rays) const;
    /// The hit solved in double for the ray o + t d, |d| = 1, near the t that `intersect` found.
    /// `time`: the ray's share of the time span.
    [[nodiscard]] SurfacePoint surface(const HitKey& key, const glm::dvec3& o, const glm::dvec3& d, double t,
                                       double time = 0) const;
    /// Of the same hit only the object and where its textures are looked up (and the distance): cheaper.
    [[nodiscard]] SurfacePoint texture_point(const HitKey& key, const glm::dvec3& o, const glm::dvec3& d,
                                             double t, double time = 0) const;
    /// The object of that hit, index into Scene::objects.
    [[nodiscard]] std::uint32_t object(const HitKey& key) const;
    /// How the outward unit normal of that hit changes: d(normal) = shape_operator * d(position), 1/m. Only
    /// for what does not move.
    [[nodiscard]] glm::dmat3 shape_operator(const HitKey& key, const SurfacePoint& at) const;
    /// How far to move a ray's origin off a surface at `p`, m: above float's rounding there, far below all
    /// else.
    [[nodiscard]] static double offset(const glm::dvec3& p);

    [[nodiscard]] const Scene& scene() const;
    /// The instant that this is the scene of; for a time span, its beginning.
    [[nodiscard]] double time_s() const;
    [[nodiscard]] const TimeSpan& span() const;
    /// Whether any object moves during the time span.
    [[nodiscard]] bool moves() const;
    /// How far the steps of moving meshes stray from the true motion, px; above the tolerance where even the
    /// most steps do not suffice.
    [[nodiscard]] double motion_error_px() const;
    /// Embree's own handle, for benchmarks that compare with a bare loop (RTCScene).
    [[nodiscard]] void* native_handle() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
