// The light that wide lobes reflect and transmit. A lens hardly sees such a lobe change from one side to the
// other, so it has no image to refocus: its mean goes into the surface's own record, and rays of the lobe are
// shared between the samples of a batch.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "tracer/distributed_tracer.h"
#include "tracer/ray_scene.h"
#include "tracer/whitted.h"

namespace postlens {

/// A point of a surface whose lobe is averaged.
struct LobeHit {
    std::uint32_t object = 0;  ///< index into Scene::objects
    NodePath path;             ///< of the node that a mirror's ray would make; names the kind of bounce
    int nodes_left = 0;        ///< along a path that begins with the lobe's ray, >= 1
    glm::dvec2 at{0};          ///< raster position of the sample, px
    glm::dvec3 origin{0};      ///< on the surface
    glm::dvec3 axis{0};        ///< unit; the exact mirrored or refracted direction
    glm::dvec3 side{0};        ///< unit geometric normal on the side that the lobe leaves to
    double exponent = 1;       ///< of the lobe cos^exponent
    glm::dvec3 weight{0};      ///< what the mean is multiplied with: throughput and share
    HitKey key;                ///< the surface that the rays leave
};

/// Means of incoming radiance over lobes cos^exponent, folded to the side they leave to, as `render` samples
/// them [phong1975].
///
/// Hits of one object and path that lie within `reach_px` and whose axes differ by less than the lobe's width
/// share their rays: hit i weighs a ray of hit j by the ratio of the two lobes' densities towards what the
/// ray met, times the squared ratio of the distances, as reused paths are weighed [bekaert2002]; weights add
/// up to one. Visibility between the two is not tested.
///
/// How many rays: 255 times the mean weight, spread over a group, so that what they all miss is worth less
/// than 1/255 of white (radiance 1). They give the standard deviation s of the radiance; then hit i is to
/// have (weight s 255)^2 rays within reach, which leaves a standard deviation of 1/255, but no hit sends more
/// than `most_rays`. Bits depend on the batch alone.
class LobeMeans {
  public:
    static constexpr double reach_px = 8;
    /// Bounds the cost of rough metals, whose noise is then some 3/255.
    static constexpr int most_rays = 2;

    /// Keeps a reference to the scene.
    LobeMeans(const RayScene& scene, const WhittedSettings& settings);

    /// means[i]: of hits[i], not yet times its weight. Rays are added to counts.reflect, .refract and
    /// .shadow. Thread-safe.
    void average(std::span<const LobeHit> hits, std::vector<glm::dvec3>& means, RayCounts& counts) const;

  private:
    struct Ray;
    struct Group;
    void trace(std::span<const LobeHit> hits, std::vector<Ray>& rays, std::size_t first,
               RayCounts& counts) const;

    Sampler sampler_;
    std::vector<DistributedTracer> tracers_;  ///< by nodes left, from 1 on
};

/// Density of the lobe, over its value at the axis, towards a unit direction on its side.
[[nodiscard]] double folded_lobe(const LobeHit& hit, const glm::dvec3& direction);

}  // namespace postlens
