// The scene, looked at along lines of sight through the lens, shaded as `render` does.
#pragma once

#include <mutex>
#include <unordered_set>

#include "reproject/sight_rays.h"
#include "tracer/distributed_tracer.h"
#include "tracer/render_setup.h"

namespace postlens {

class SceneRays : public SightRays {
  public:
    /// `lines`: of a pixel at most, and SightLine::view below that. Keeps a reference to `setup`, which must
    /// not have a real lens.
    SceneRays(const RenderSetup& setup, const DistributedSettings& settings, int lines,
              std::uint64_t seed = 1);
    void trace(std::span<const SightLine> lines, const LightElsewhere& less,
               std::span<std::array<float, 3>> radiance) const override;
    [[nodiscard]] bool steady(NodePath path, std::uint32_t id) const override;
    /// Of all that was traced.
    [[nodiscard]] RayCounts counts() const;

  private:
    const RenderSetup& setup_;
    Sampler sampler_;
    DistributedTracer tracer_;
    bool steady_mirrors_ = true;                  ///< no lobe of any material spreads what it shows
    std::unordered_set<std::uint32_t> unsteady_;  ///< ids of surfaces that sample lights or lobes of theirs
    mutable std::mutex mutex_;
    mutable RayCounts counts_;
};

}  // namespace postlens
