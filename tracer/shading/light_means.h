// Computes the radiance that a surface point reflects from an area light, averaged over the light.
// It can be stored with the surface, because a penumbra looks the same from every lens point.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/shading.h"

namespace postlens {

/// A surface point that is lit by an area light, and the radiance that results.
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
    /// Noise-free estimate of the radiance: the radiance without shadows, times 1 if the light is visible,
    /// 0.5 if it is partly visible, or 0 if it is hidden.
    glm::dvec3 steady{0};
};

/// Computes the mean radiance that a surface reflects from an area light.
/// First, twelve shadow rays test the light's visibility: eight to its outline and one to each quarter.
/// If their transmittances agree, the result is the unshadowed mean times the transmittance.
/// Otherwise the light is divided into k x k cells, each with one shadow ray to a random point.
class LightMeans {
  public:
    static constexpr int most_cells = 16;

    explicit LightMeans(const RayScene& scene) : scene_(scene) {}
    /// Sets the mean radiance that each of the `points` reflects from its area light. `rays` is a temporary
    /// buffer. Thread-safe.
    /// Adds the number of rays to `shadow_rays`.
    void average(std::vector<ExtentLit>& points, RayBatch& rays, std::uint64_t& shadow_rays) const;

  private:
    const RayScene& scene_;
};

}  // namespace postlens
