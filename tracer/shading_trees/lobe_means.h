// Computes the mean radiance that a glossy surface receives from its lobe, a cone of directions around that
// of exact reflection or refraction. To save rays, a ray that is traced for one surface point also counts for
// points nearby. If the lobe is wide, the mean is almost the same from every lens point. Therefore, it is
// stored as part of the surface's own radiance.
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
    NodePath path;             ///< path of the node that the ray of an exact mirror or glass would create
    int nodes_left = 0;    ///< greatest number of nodes along a path that begins with a ray of the lobe, >= 1
    glm::dvec2 at{0};      ///< raster position of the sample, px
    glm::dvec3 origin{0};  ///< on the surface
    glm::dvec3 axis{0};    ///< exact direction of reflection or refraction, unit length
    glm::dvec3 side{0};    ///< geometric normal on the side of the lobe, unit length
    double exponent = 1;   ///< exponent of the lobe cos^exponent
    glm::dvec3 weight{0};  ///< factor of the mean: throughput times coefficient
    HitKey key;            ///< the surface that the rays leave
    /// What the hit adds to its image sample without its glossy lobes: its radiance times the throughput,
    /// i.e. the fraction of this radiance that reaches the eye. The brighter this is, the less visible is the
    /// noise that random rays into the lobes cause in the sample. So fewer rays are then traced.
    glm::dvec3 beside{0};
};

/// Computes means of incoming radiance over lobes cos^exponent [phong1975].
/// As in `render`, directions on the wrong side of the surface are mirrored to the right side.
///
/// Hits of one object and path share rays if they lie within `reach_px` and their lobes are similar.
/// The weight of a ray of hit j in the mean of hit i is a product of two ratios [bekaert2002]:
/// - the lobe densities of i and j in the direction of the ray's end point
/// - the squared distances of j and i to the end point
///
/// The weights are normalised to a sum of 1. Visibility between hit i and the end point is not tested.
///
/// The first pass sends 510 rays times the mean weight of a group of hits, but at most one ray per hit.
/// If the rays may see a radiance above 1 (white), it sends more in proportion.
/// A feature that all of these rays miss contributes less than 1/510 of white.
///
/// The second pass sends (weight s f 510)^2 rays around each hit, but at most `most_rays` per hit.
/// - s: standard deviation of the radiance in the first pass
/// - f: slope of the sRGB curve at the radiance of the node
///
/// The standard deviation of the image value then becomes 1/510, unless `most_rays` limits the rays.
/// The result depends only on the batch, and is bit-identical in every run.
class LobeMeans {
  public:
    static constexpr double reach_px = 16;
    /// Largest number of rays per glossy surface hit. Rough metals then have noise of about 4/255 in the
    /// image.
    static constexpr int most_rays = 4;

    /// Keeps a reference to the scene.
    LobeMeans(const RayScene& scene, const WhittedSettings& settings);

    /// Sets means[i] to the mean radiance that arrives at the surface point hits[i] from the directions of
    /// its glossy lobe. To get what this adds to the image sample, the caller must multiply it by
    /// hits[i].weight, which contains the reflectance and the losses on the way to the eye. Adds the numbers
    /// of traced rays of each kind to `counts`. Thread-safe.
    void average(std::span<const LobeHit> hits, std::vector<glm::dvec3>& means, RayCounts& counts) const;

  private:
    struct Ray;
    struct Group;
    void trace(std::span<const LobeHit> hits, std::vector<Ray>& rays, std::size_t first,
               RayCounts& counts) const;

    Sampler sampler_;
    std::vector<DistributedTracer> tracers_;  ///< one for each number of nodes left, from 1 on
    std::vector<double> bound_;  ///< for each number of nodes left, an upper bound of the radiance of a ray
};

/// Returns how densely the random directions of the glossy lobe of `hit` lie around the unit direction
/// `direction`. The lobe is cos^exponent, and 1 is the density of this function on the lobe's axis. Random
/// directions that point into the surface are mirrored to its front. Therefore, the result is 0 for
/// directions into the surface, and is increased for their mirror directions.
[[nodiscard]] double folded_lobe(const LobeHit& hit, const glm::dvec3& direction);

}  // namespace postlens
