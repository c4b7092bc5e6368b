// The light of sources with an extent at a point: the mean over the source, as a penumbra does not depend on
// the lens.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "tracer/ray_scene.h"
#include "tracer/shading.h"

namespace postlens {

/// A surface point lit by one source with an extent.
struct ExtentLit {
    const PlacedLight* light = nullptr;
    const Material* material = nullptr;
    SurfacePoint surface;
    Facing facing;
    glm::dvec3 colour{1};      ///< surface_colour
    glm::dvec3 direction{0};   ///< of the ray that sees the surface
    glm::dvec3 throughput{1};  ///< what the radiance is multiplied with later
    HitKey key;
    std::uint64_t seed = 0;  ///< of the points on the source

    glm::dvec3 radiance{0};  ///< result: with shadows
    /// Result without noise of the points: the unshadowed radiance times 1 where all of the source is seen, 0
    /// where none is, and a half between.
    glm::dvec3 steady{0};
};

/// First, points around the source's outline and one in each quarter tell whether all of it is seen. Where
/// they agree, the result is the unshadowed mean times what passes. Where they disagree, k^2 jittered points
/// in k^2 cells of equal share are each shaded with their own shadow ray. A straight shadow's edge crosses
/// about k of the cells, which leaves a standard deviation of L / (2 k^1.5) for unshadowed radiance L; k is
/// such that this is 2/255 of white (radiance 1), 4 to `most_cells`. A pixel is the mean of four such records
/// at least, and so has 1/255.
class LightMeans {
  public:
    static constexpr int most_cells = 16;

    explicit LightMeans(const RayScene& scene) : scene_(scene) {}
    /// Fills in the results. `rays` is a buffer. Shadow rays are counted. Thread-safe.
    void average(std::vector<ExtentLit>& points, RayBatch& rays, std::uint64_t& shadow_rays) const;

  private:
    const RayScene& scene_;
};

}  // namespace postlens
