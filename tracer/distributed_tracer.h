// Distributed ray tracing [cook1984]: every eye ray with its own point of the lens and its own instant;
// shadow rays spread over lights, mirrored and refracted rays about their exact directions.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "records/record.h"
#include "reproject/sight_rays.h"
#include "tracer/ray_scene.h"
#include "tracer/sampler.h"
#include "tracer/shading.h"
#include "tracer/whitted.h"

namespace postlens {

struct DistributedSettings {
    int max_depth = 5;               ///< nodes along a path, as WhittedSettings
    double min_contribution = 1e-3;  ///< radiance; as WhittedSettings
    /// Russian roulette: a mirrored or refracted ray is followed with the probability of its share, and then
    /// counts in full. The mean stays; there are fewer rays, and more noise.
    bool roulette = false;
};

/// Eye rays and what their numbers come from.
struct EyeRays {
    RayBatch rays;
    std::vector<std::uint32_t> pixel;  ///< the sampler's pixel
    std::vector<int> index;            ///< the sampler's index
    std::vector<float> weight;         ///< how much of its light the lens lets through; empty: all
    /// What the radiance of each ray is multiplied with in the end, for `min_contribution`; empty: 1.
    std::vector<double> importance;
    const LightElsewhere* less = nullptr;  ///< what no ray is to see; null: all is seen
    /// With that: where the pinhole sees what a ray meets after t, raster px.
    std::function<glm::dvec2(std::size_t ray, double t)> recorded_at;
    std::vector<glm::dvec3> radiance;  ///< the result
};

class DistributedTracer {
  public:
    /// Keeps references to scene and sampler.
    DistributedTracer(const RayScene& scene, const Sampler& sampler, const DistributedSettings& settings);

    /// Follows the rays to the end of their shading trees. Thread-safe; the same rays in the same groups give
    /// the same bits.
    void trace(EyeRays& eye, RayCounts& counts) const;

    /// Whether eye rays go to Embree as coherent: with a lens it makes no difference, with a pinhole twice
    /// the speed, and where geometry moves it costs nearly half (docs/performance.md).
    [[nodiscard]] bool coherent() const { return !scene_.moves(); }
    /// Whether rays need their times: something other than the camera moves.
    [[nodiscard]] bool needs_times() const { return scene_.moves() || moving_lights_; }

  private:
    struct PathRay;
    struct Workspace;
    // What a hit on an object asks for, from the least to all.
    enum class Answer : std::uint8_t {
        constant,  // the same radiance everywhere
        texture,   // radiance by texture alone
        full,      // lights, mirrors, glass
    };
    void shade(const PathRay& ray, const SurfacePoint& s, const HitKey& key, EyeRays& eye, Workspace& w,
               RayCounts& counts) const;
    void light(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, const glm::dvec3& colour, std::uint32_t limited, EyeRays& eye, Workspace& w,
               RayCounts& counts) const;
    void spawn(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, const EyeRays& eye, Workspace& w, RayCounts& counts) const;
    void resolve_shadows(EyeRays& eye, Workspace& w) const;
    /// Whether some of a node's light is not to be seen.
    [[nodiscard]] bool limits(const PathRay& ray, std::uint32_t object, double t, const EyeRays& eye) const;

    const RayScene& scene_;
    const Sampler& sampler_;
    DistributedSettings settings_;
    std::vector<double> bound_;
    std::vector<Answer> answers_;          // per object
    std::vector<glm::dvec3> constant_;     // per object
    std::vector<PlacedLight> lights_;      // at the shutter's opening
    std::vector<MotionPath> light_paths_;  // of lights that move while it is open; else empty
    std::vector<bool> light_moves_;
    bool moving_lights_ = false;
};

/// A direction spread about `axis` in a lobe cos^exponent [phong1975]; (u, v) in [0, 1)^2. Infinity: the axis
/// itself.
[[nodiscard]] glm::dvec3 spread_direction(const glm::dvec3& axis, double exponent, const glm::dvec2& uv);

}  // namespace postlens
