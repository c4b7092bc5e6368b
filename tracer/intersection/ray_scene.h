// A scene prepared for ray tracing, at one instant or for a shutter interval.
// Embree finds hits in single precision. They are then computed again in double precision.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.h"
#include "tracer/intersection/motion_steps.h"

namespace postlens {

/// A shutter interval, in seconds. Rays store their instant as a fraction of it, from 0 to 1.
struct TimeSpan {
    double open_s = 0, close_s = 0;
    [[nodiscard]] double at(double share) const { return open_s + share * (close_s - open_s); }
};

/// Identifies one primitive of the Embree scene. It is the primitive that a ray hits, or the one on which a
/// ray starts and which it must not hit again there.
struct HitKey {
    static constexpr std::uint32_t none = 0xFFFFFFFFU;
    std::uint32_t geometry = none, primitive = none, instance = none;
    friend constexpr bool operator==(const HitKey&, const HitKey&) = default;
    [[nodiscard]] bool valid() const { return geometry != none; }
};

/// A batch of rays, stored as a structure of arrays. Groups of 16 rays are traced together.
/// The rays of a group should start close together and have similar directions.
class RayBatch {
  public:
    static constexpr int group = 16;
    int count = 0;  ///< rays in use
    std::vector<float> ox, oy, oz, dx, dy, dz, t_far;
    bool has_sources = false;    ///< false if no ray of the batch starts on a surface
    std::vector<HitKey> source;  ///< the surface each ray leaves
    bool has_times = false;      ///< false if the time of all rays is the opening of the shutter
    std::vector<float> time;     ///< fraction of the time span, 0 to 1
    // Results.
    std::vector<std::uint32_t> hit_geometry, hit_primitive, hit_instance;
    std::vector<float> t;  ///< distance to the hit, in lengths of the direction vector
    // Result of `occlude`: transmittance per channel.
    std::vector<glm::dvec3> transmittance;

    /// Returns the geometry, primitive and instance that ray i hit, or `none` if it hit nothing.
    [[nodiscard]] HitKey hit(std::size_t i) const {
        return {hit_geometry[i], hit_primitive[i], hit_instance[i]};
    }

    void clear(bool with_sources, bool with_times = false) {
        count = 0;
        has_sources = with_sources;
        has_times = with_times;
    }
    /// Appends 16 rays, which the caller must then set, and returns the index of the first.
    std::size_t add_group() {
        const auto first = static_cast<std::size_t>(count);
        while (first + group > ox.size()) grow();
        count += group;
        return first;
    }
    void add(const glm::dvec3& o, const glm::dvec3& d, float far, const HitKey& from = {}, float at = 0) {
        const auto i = static_cast<std::size_t>(count);
        if (i == ox.size()) grow();
        // Converts all numbers before storing any. Otherwise, the compiler reloads the array pointers after
        // each store.
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

/// The surface at a hit point, in world space.
struct SurfacePoint {
    double t = 0;  ///< distance along the (unit) ray, m
    glm::dvec3 position{0};
    glm::dvec3 geometric_normal{0, 0, 1};  ///< unit, outward
    glm::dvec3 normal{0, 0, 1};            ///< unit, outward; interpolated on smooth meshes
    glm::dvec3 object_position{0};         ///< position in object space, for textures
    glm::dvec2 uv{0};
    glm::vec3 colour{1};       ///< interpolated from the vertex colours of the mesh; 1 if there are none
    std::uint32_t object = 0;  ///< index into Scene::objects
    int part = 0;              ///< face or cap of an analytic shape
};

class RayScene {
  public:
    /// Builds the scene at one instant. Keeps a reference to `scene`.
    /// Throws Error(interrupted) if the user interrupts the build.
    RayScene(const Scene& scene, double time_s);
    /// Builds the scene for a shutter interval, in which every ray has its own instant.
    /// Analytic shapes move exactly. Meshes move in as many linear steps as `accuracy` needs.
    RayScene(const Scene& scene, const TimeSpan& span, const MotionAccuracy& accuracy);
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;
    RayScene(RayScene&&) = delete;
    RayScene& operator=(RayScene&&) = delete;

    /// Finds the nearest hit of every ray. `coherent` means that the rays of each group of 16 are almost
    /// parallel.
    void intersect(RayBatch& rays, bool coherent) const;
    /// Computes the transmittance along each shadow ray. Rays are not refracted [whitted1980].
    /// Each crossing of a transparent surface multiplies the transmittance by the surface's colour.
    void occlude(RayBatch& rays) const;
    /// Computes the surface point that the ray o + t d, |d| = 1, hits, in double precision.
    /// `t` is the distance found by `intersect`, and `time` the ray's instant, 0 to 1.
    [[nodiscard]] SurfacePoint surface(const HitKey& key, const glm::dvec3& o, const glm::dvec3& d, double t,
                                       double time = 0) const;
    /// Like `surface`, but faster: computes only the object, texture position and distance of the hit.
    [[nodiscard]] SurfacePoint texture_point(const HitKey& key, const glm::dvec3& o, const glm::dvec3& d,
                                             double t, double time = 0) const;
    /// Returns the object that was hit, as an index into Scene::objects.
    [[nodiscard]] std::uint32_t object(const HitKey& key) const;
    /// Returns the derivative of the outward unit normal, 1/m: d(normal) = shape_operator * d(position).
    /// Only for objects that do not move.
    [[nodiscard]] glm::dmat3 shape_operator(const HitKey& key, const SurfacePoint& at) const;
    /// Returns how far, in metres, a ray's origin is moved off a surface at `p`, so as not to hit the surface
    /// again.
    [[nodiscard]] static double offset(const glm::dvec3& p);

    [[nodiscard]] const Scene& scene() const;
    /// Returns the beginning of the shutter interval, in seconds. Without a shutter, this is the instant of
    /// the scene.
    [[nodiscard]] double time_s() const;
    [[nodiscard]] const TimeSpan& span() const;
    /// True if an object moves during the shutter interval.
    [[nodiscard]] bool moves() const;
    /// Returns the largest position error, px, of moving meshes, whose motion is approximated by linear
    /// steps. It may exceed the tolerance, because the number of steps is limited.
    [[nodiscard]] double motion_error_px() const;
    /// Returns the Embree scene (RTCScene), for benchmarks.
    [[nodiscard]] void* native_handle() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
