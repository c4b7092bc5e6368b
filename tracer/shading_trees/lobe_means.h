// Mean radiance over wide lobes of reflection and transmission. Rays of all samples of a batch are shared to
// compute the mean. The mean is nearly the same from every lens point, so it is added to the record of the
// surface instead of a record of its own.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/distributed_tracer.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// A point of a surface whose lobe is averaged.
struct LobeHit {
    std::uint32_t object = 0;  ///< index into Scene::objects
    NodePath path;             ///< path of the node that an exact mirror's or glass's ray would create
    int nodes_left = 0;    ///< greatest number of nodes along a path that begins with the lobe's ray, >= 1
    glm::dvec2 at{0};      ///< raster position of the sample, px
    glm::dvec3 origin{0};  ///< on the surface
    glm::dvec3 axis{0};    ///< exact direction of reflection or refraction, unit length
    glm::dvec3 side{0};    ///< geometric normal on the side of the lobe, unit length
    double exponent = 1;   ///< of the lobe cos^exponent
    glm::dvec3 weight{0};  ///< factor of the mean: throughput times coefficient
    HitKey key;            ///< the surface that the rays leave
};

/// Means of incoming radiance over lobes cos^exponent [phong1975], as `render` samples them: directions on
/// the wrong side of the surface are mirrored to the right side.
///
/// Hits of one object and one path share rays if they lie within `reach_px` of each other and their axes
/// differ by less than the width of the lobe. Hit i weights a ray of hit j by the ratio of the two lobe
/// densities in the direction of the ray's end point, times the squared ratio of the distances [bekaert2002].
/// The weights are normalised to a sum of 1. Visibility between hit i and the end point is not tested.
///
/// Number of rays: a first pass sends 255 times the mean weight of the group, evenly spaced over its hits. A
/// feature that all of these rays miss then contributes less than 1/255 of white (radiance 1). The rays give
/// an estimate of the standard deviation s of the radiance. A second pass gives hit i (weight s 255)^2 rays
/// within its reach, which leaves a standard deviation of 1/255, but at most `most_rays` per hit. The bits
/// depend on the batch alone.
class LobeMeans {
  public:
    static constexpr double reach_px = 16;
    /// Limits the cost of rough metals, which then have a noise of about 3/255 of white.
    static constexpr int most_rays = 2;

    /// Keeps a reference to the scene.
    LobeMeans(const RayScene& scene, const WhittedSettings& settings);

    /// Sets means[i] to the mean radiance over the lobe of hits[i], not multiplied by hits[i].weight. Adds
    /// the numbers of rays traced to counts.reflect, counts.refract and counts.shadow. Thread-safe.
    void average(std::span<const LobeHit> hits, std::vector<glm::dvec3>& means, RayCounts& counts) const;

  private:
    struct Ray;
    struct Group;
    void trace(std::span<const LobeHit> hits, std::vector<Ray>& rays, std::size_t first,
               RayCounts& counts) const;

    Sampler sampler_;
    std::vector<DistributedTracer> tracers_;  ///< one per number of nodes left, from 1 on
};

/// Density of the lobe in a unit direction, relative to cos^exponent at its axis, with the part on the wrong
/// side of the surface mirrored to the right side. 0 for directions on the wrong side.
[[nodiscard]] double folded_lobe(const LobeHit& hit, const glm::dvec3& direction);

}  // namespace postlens
