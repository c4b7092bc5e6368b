// Data for Embree's callbacks: the analytic shapes of the scene, and the context of a batch of rays.
#pragma once

#include <array>
#include <cstdint>
#include <embree3/rtcore.h>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "records/motion/motion_path.h"
#include "tracer/intersection/analytic_shape.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Tells how an object affects shadow rays. For each colour channel, `log_transmission` is -log2 of the
/// fraction of light that passes one surface of the object, as a fixed-point integer. The sum of these
/// integers along a ray does not depend on the order of the surfaces.
struct ObjectShadow {
    bool casts = true;
    bool transmits = false;
    std::array<std::int64_t, 3> log_transmission{};
};
inline constexpr std::int64_t log_opaque = std::int64_t{1} << 50;
[[nodiscard]] std::int64_t fixed_log(double transmission);
[[nodiscard]] double from_fixed_log(std::int64_t sum);

/// Interval of time [begin, end) in which an Embree instance of a moving mesh exists. There is one instance
/// for each interval between keyframes. The times are fractions of the shutter interval.
struct Lifetime {
    float begin = 0, end = std::numeric_limits<float>::infinity();
};

/// What Embree's callbacks need to know about a batch of rays.
/// `base` must be the first member: Embree passes its address to the callbacks.
struct RayContext {
    RTCIntersectContext base{};
    const HitKey* sources = nullptr;        ///< per ray id; null if no ray starts on a surface
    const ObjectShadow* shadows = nullptr;  ///< per object
    const std::uint32_t* object_of_geometry =
        nullptr;  ///< per geometry id of the top-level scene; valid for meshes and instances
    std::array<std::int64_t, 3>* log_transmission = nullptr;  ///< per ray id: sum over its crossings
    const Lifetime* lifetimes =
        nullptr;  ///< per geometry id of the top-level scene; null if all exist during the whole span
};

/// The objects of a scene that are spheres in world space and do not move. Each sphere is stored twice. The
/// float values are used to find hits fast, and the double values to compute the hits exactly.
struct SphereSet {
    std::vector<glm::vec3> centre;
    std::vector<float> radius;
    std::vector<glm::dvec3> exact_centre;
    std::vector<double> exact_radius;
    std::vector<std::uint32_t> object;

    void add(const glm::dvec3& c, double r, std::uint32_t of) {
        centre.emplace_back(c);
        radius.push_back(static_cast<float>(r));
        exact_centre.push_back(c);
        exact_radius.push_back(r);
        object.push_back(of);
    }
};

/// Analytic shapes that do not move and are not in SphereSet.
struct AnalyticSet {
    struct Item {
        AnalyticShape shape;
        glm::dmat4 local_from_world{1};
        glm::dmat4 object_from_local{1};
        std::uint32_t object = 0;
        glm::dvec3 flat_normal{0};  // unit, in world space; only for flat shapes
        // local_from_world in single precision: local = linear * (p - pivot) + shift.
        // Subtracting the pivot first preserves precision far from the world's origin.
        glm::mat3 linear{1};
        glm::vec3 pivot{0}, shift{0};
    };
    std::vector<Item> items;
    std::vector<glm::vec3> lower, upper;  ///< world bounds
};

/// The moving analytic shapes of a scene. Rays are transformed into the space in which a shape is at rest.
struct MovingSet {
    struct Item {
        AnalyticShape shape;
        glm::dmat4 local_from_base{1};  ///< base: the world before the motion
        glm::dmat4 object_from_local{1};
        std::uint32_t object = 0;
        std::size_t path = 0;
    };
    std::vector<MotionPath> paths;
    std::vector<Item> items;
    TimeSpan span;
    int steps = 1;                        ///< boxes are given at steps + 1 evenly spaced instants
    std::vector<glm::vec3> lower, upper;  ///< index: item * (steps + 1) + step

    /// A ray in the item's local frame.
    struct LocalRay {
        glm::dvec3 o, d;
    };
    [[nodiscard]] LocalRay local_ray(const Item& item, const glm::dvec3& o, const glm::dvec3& d,
                                     double time) const {
        const MotionPath::Pose pose = paths[item.path].at(span.at(time));
        return {glm::dvec3(item.local_from_base * glm::dvec4(pose.unmoved_point(o), 1)),
                glm::dvec3(item.local_from_base * glm::dvec4(pose.unmoved_direction(d), 0))};
    }
};

/// These functions create an Embree geometry that intersects rays with the shapes of a set.
/// The set must outlive the geometry.
[[nodiscard]] RTCGeometry sphere_geometry(RTCDevice device, SphereSet& set);
[[nodiscard]] RTCGeometry analytic_geometry(RTCDevice device, AnalyticSet& set);
[[nodiscard]] RTCGeometry moving_geometry(RTCDevice device, MovingSet& set);

/// Filters that Embree calls for hits on triangles. `filter_source` rejects the triangle where a ray starts.
/// `filter_shadow`, for shadow rays, also rejects surfaces that transmit light or cast no shadow.
void filter_source(const RTCFilterFunctionNArguments* args);
void filter_shadow(const RTCFilterFunctionNArguments* args);

/// Attenuates a shadow ray that crosses the surface of an object `crossed` times. Returns true if no light is
/// left.
[[nodiscard]] inline bool stops_light(const RayContext& context, std::uint32_t object, unsigned ray_id,
                                      int crossed) {
    const ObjectShadow& s = context.shadows[object];
    if (!s.casts) return false;
    if (!s.transmits) return true;
    auto& sum = context.log_transmission[ray_id];
    bool dark = true;
    for (std::size_t c = 0; c < 3; ++c) {
        sum[c] = std::min(sum[c] + crossed * s.log_transmission[c], log_opaque);
        dark = dark && sum[c] >= log_opaque;
    }
    return dark;
}

}  // namespace postlens
