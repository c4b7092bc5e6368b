// Computes the radiance that a surface point reflects from an area light, as a mean over the light. A
// penumbra looks the same from every lens point, so a record can store this mean.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/shading.h"

namespace postlens {

/// A surface point that is lit by one light source with an extent.
struct ExtentLit {
    const PlacedLight* light = nullptr;
    const Material* material = nullptr;
    SurfacePoint surface;
    Facing facing;
    glm::dvec3 colour{1};      ///< surface_colour
    glm::dvec3 direction{0};   ///< direction of the ray that sees the surface
    glm::dvec3 throughput{1};  ///< factor of the radiance that the record stores
    HitKey key;
    std::uint64_t seed = 0;  ///< seed of the sample points on the light source

    glm::dvec3 radiance{0};  ///< result: radiance with shadows, before `throughput`
    /// Radiance without noise, which determines subdivision. It is the unshadowed radiance times a factor: 1
    /// if the light source is completely visible, 0 if it is hidden, and 1/2 otherwise.
    glm::dvec3 steady{0};
};

/// Averages the radiance over an area light. Twelve shadow rays test the visibility of the source: eight to
/// its outline and one to each quarter. If they agree, the result is the unshadowed mean times the
/// transmittance. If they differ, the source is divided into k^2 cells of equal size, and a jittered point of
/// each cell is shaded with its own shadow ray. A straight shadow edge crosses about k cells, so the standard
/// deviation is L / (2 k^1.5) for an unshadowed radiance L. k is 4 to `most_cells`, and is chosen for a
/// standard deviation of 2/255 of white (radiance 1). A pixel is the mean of at least four such records, so
/// its standard deviation is 1/255.
class LightMeans {
  public:
    static constexpr int most_cells = 16;

    explicit LightMeans(const RayScene& scene) : scene_(scene) {}
    /// Sets the results of all points. `rays` is a temporary buffer. Adds the number of rays to
    /// `shadow_rays`. Thread-safe.
    void average(std::vector<ExtentLit>& points, RayBatch& rays, std::uint64_t& shadow_rays) const;

  private:
    const RayScene& scene_;
};

}  // namespace postlens
