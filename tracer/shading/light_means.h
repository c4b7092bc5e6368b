// Computes the radiance that a surface point reflects from an area light, averaged over the light's area. A
// penumbra (the soft edge of a shadow) looks the same from every lens point. Therefore, this mean can be
// stored with the surface.
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
    /// Result: an estimate of `radiance` (above) without random noise, for comparisons between samples.
    /// Shadow rays to at most twelve points of the light are traced. If all have the same transmittance, such
    /// as 1 (visible) or 0 (hidden), the radiance that the light would cause without shadows is multiplied by
    /// it. Otherwise, it is multiplied by 0.5.
    glm::dvec3 steady{0};
};

/// Computes the mean radiance that a surface reflects from an area light. First, twelve shadow rays test how
/// visible the light is: eight rays to its outline and one to each of its quarters. If all of them have the
/// same transmittance, the result is this transmittance times the mean radiance without shadows. Otherwise,
/// the light is divided into k x k cells, and one shadow ray is sent to a random point of each cell.
class LightMeans {
  public:
    static constexpr int most_cells = 16;

    explicit LightMeans(const RayScene& scene) : scene_(scene) {}
    /// Computes the result of each element of `points`. An element describes one surface point and one area
    /// light that illuminates it (ExtentLit::light), and the result is the mean radiance that the point
    /// reflects from this light. `rays` is a temporary buffer. The number of traced rays is added to
    /// `shadow_rays`. Thread-safe.
    void average(std::vector<ExtentLit>& points, RayBatch& rays, std::uint64_t& shadow_rays) const;

  private:
    const RayScene& scene_;
};

}  // namespace postlens
