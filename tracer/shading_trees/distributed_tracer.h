// Distributed ray tracing [cook1984]. Eye rays sample the lens and the shutter, shadow rays the area of
// lights. Reflected and refracted rays sample the lobes of rough surfaces.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "records/record.h"
#include "reproject/sight_rays.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/sampling/sampler.h"
#include "tracer/shading/shading.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

struct DistributedSettings {
    int max_depth = 5;               ///< nodes along a path, as in WhittedSettings
    double min_contribution = 1e-3;  ///< radiance, as in WhittedSettings
    /// Russian roulette: a reflected or refracted ray is traced only with a certain probability, the largest
    /// colour channel of its weight. The weight is divided by this probability, so that the mean stays the
    /// same. This needs fewer rays but gives more noise.
    bool roulette = false;
};

/// A batch of eye rays, the random samples from which they are made, and the radiance that they see.
struct EyeRays {
    RayBatch rays;
    std::vector<std::uint32_t> pixel;  ///< the sampler's pixel
    std::vector<int> index;            ///< the sampler's index
    std::vector<float> weight;         ///< transmittance of the lens for each ray; 1 if empty
    /// The weight with which the radiance of each eye ray counts in the image. It is used only to save time:
    /// a reflection or refraction is not traced if it contributes less than `min_contribution` to the image.
    /// If this list is empty, all weights are 1.
    std::vector<double> importance;
    const LightElsewhere* less = nullptr;  ///< radiance to leave out, added as highlights; may be null
    /// Returns the raster position, px, at which a camera without a lens (pinhole) would see a point of an
    /// eye ray. `ray` is the index of the eye ray, and `t` is the distance of the point from the ray's
    /// origin, m. The position is needed because the records were traced from the pinhole, but the eye ray
    /// may come from another lens point.
    std::function<glm::dvec2(std::size_t ray, double t)> recorded_at;
    std::vector<glm::dvec3> radiance;  ///< the result
    /// Result: the radiance that `less` excludes. Empty if `less` is null.
    std::vector<glm::dvec3> left_out;
    /// Optional: one surface for each eye ray, given by its object and by the bounces through which it is
    /// seen. `less` describes bright light that is excluded from the traced radiance, because it is added to
    /// the image separately, as highlights. If this list is given, `left_out` receives only the light that is
    /// excluded from these surfaces, and `radiance` is not valid.
    std::vector<NodeIdentity> left_out_of;
};

class DistributedTracer {
  public:
    /// Keeps references to scene and sampler.
    DistributedTracer(const RayScene& scene, const Sampler& sampler, const DistributedSettings& settings);

    /// Traces all eye rays with their reflections, refractions and shadow rays, and sets `eye.radiance`.
    /// Thread-safe. The same rays in the same order give bit-identical results.
    void trace(EyeRays& eye, RayCounts& counts) const;

    /// Returns true if Embree, which traces the rays, is told that eye rays are coherent, i.e. close
    /// together. For a pinhole, this hint doubles the speed if no geometry moves. With moving geometry, the
    /// hint would almost halve the speed (docs/performance.md), so it is not given.
    [[nodiscard]] bool coherent() const { return !scene_.moves(); }
    /// Returns true if objects or lights move. Then each eye ray needs the instant at which it is traced.
    [[nodiscard]] bool needs_times() const { return scene_.moves() || moving_lights_; }

  private:
    struct PathRay;
    struct Workspace;
    enum class Answer : std::uint8_t {
        constant,  // the radiance is constant
        texture,   // the radiance depends only on the texture
        full,      // the object is lit, reflects or transmits
    };
    void shade(const PathRay& ray, const SurfacePoint& s, const HitKey& key, EyeRays& eye, Workspace& w,
               RayCounts& counts) const;
    void light(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, const glm::dvec3& colour, std::uint32_t limited, EyeRays& eye, Workspace& w,
               RayCounts& counts) const;
    void spawn(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, const EyeRays& eye, Workspace& w, RayCounts& counts) const;
    void resolve_shadows(EyeRays& eye, Workspace& w) const;
    /// Returns whether a node's radiance is clamped (LightElsewhere).
    [[nodiscard]] bool limits(const PathRay& ray, std::uint32_t object, double t, const EyeRays& eye) const;
    [[nodiscard]] bool counts_as_left_out(const PathRay& ray, std::uint32_t object, const EyeRays& eye) const;
    [[nodiscard]] bool wants_light(const PathRay& ray, std::uint32_t object, const EyeRays& eye) const {
        return eye.left_out_of.empty() || counts_as_left_out(ray, object, eye);
    }

    const RayScene& scene_;
    const Sampler& sampler_;
    DistributedSettings settings_;
    std::vector<double> bound_;
    std::vector<Answer> answers_;          // per object
    std::vector<glm::dvec3> constant_;     // per object
    std::vector<PlacedLight> lights_;      // at the shutter's opening
    std::vector<MotionPath> light_paths_;  // per light
    std::vector<bool> light_moves_;
    bool moving_lights_ = false;
};

/// Returns a random direction in the glossy lobe cos^exponent about `axis` [phong1975].
/// u and v are random numbers in [0, 1). Returns `axis` if the exponent is infinite.
[[nodiscard]] glm::dvec3 spread_direction(const glm::dvec3& axis, double exponent, const glm::dvec2& uv);

}  // namespace postlens
