// Traces rays that start at given points of the lens. These rays replace those parts of an image that would
// be wrong if they were made from recorded surfaces, for example because a surface is not recorded there.
// Surfaces are shaded as by the command `render`.
#pragma once

#include <mutex>
#include <unordered_set>

#include "reproject/sight_rays.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

class SceneRays : public SightRays {
  public:
    /// Prepares to trace rays through the scene of `setup`, for points of views that the recorded surfaces do
    /// not determine. A view is the image for one lens point and instant.
    /// - `setup`: must outlive this object; its camera must not have a lens prescription (a real lens),
    ///   because these rays start at given points of an ideal lens
    /// - `lines`: largest number of rays per pixel
    SceneRays(const RenderSetup& setup, const DistributedSettings& settings, int lines,
              std::uint64_t seed = 1);
    void trace(std::span<const SightLine> lines, const LightElsewhere& less,
               std::span<std::array<float, 3>> radiance) const override;
    void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                         const LightElsewhere& less, std::span<std::array<float, 3>> radiance) const override;
    void inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                        std::span<glm::dvec3> inverse_z) const override;
    [[nodiscard]] bool steady(NodePath path, std::uint32_t id) const override;
    /// Returns the number of recorded patches (flat parts of surfaces) per ray up to which reflections are
    /// drawn from patches and not traced. Drawing 32 patches takes as long as tracing one ray, as measured on
    /// six scenes.
    [[nodiscard]] std::size_t patches_per_ray() const override { return 32; }
    /// Returns the number of rays traced so far.
    [[nodiscard]] RayCounts counts() const;

  private:
    void aim(std::span<const SightLine> lines, EyeRays& eye) const;
    /// Traces the sight lines. The results are the members of `eye`.
    void trace(std::span<const SightLine> lines, const LightElsewhere& less, EyeRays& eye) const;

    const RenderSetup& setup_;
    Sampler sampler_;
    DistributedTracer tracer_;
    bool steady_mirrors_ = true;  ///< no material reflects or transmits into a lobe
    std::unordered_set<std::uint32_t>
        unsteady_;  ///< ids of objects whose radiance depends on sampled lights or sampled lobe directions
    mutable std::mutex mutex_;
    mutable RayCounts counts_;
};

}  // namespace postlens
