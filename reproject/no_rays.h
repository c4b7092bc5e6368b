// A ray tracer whose rays see nothing.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "reproject/sight_rays.h"

namespace postlens {

/// Stands in for the ray tracer: its rays return black. With it, a caller finds out which samples need rays,
/// without tracing them.
class NoRays : public SightRays {
  public:
    void trace(std::span<const SightLine> /*lines*/, const LightElsewhere& /*less*/,
               std::span<std::array<float, 3>> radiance) const override {
        std::fill(radiance.begin(), radiance.end(), std::array<float, 3>{});
    }
    void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> /*of*/,
                         const LightElsewhere& less,
                         std::span<std::array<float, 3>> radiance) const override {
        trace(lines, less, radiance);
    }
    void inverse_depths(std::span<const SightLine> /*lines*/, std::uint32_t /*id*/,
                        std::span<glm::dvec3> inverse_z) const override {
        std::fill(inverse_z.begin(), inverse_z.end(), glm::dvec3(0));
    }
    [[nodiscard]] bool steady(NodePath /*path*/, std::uint32_t /*id*/) const override { return true; }
};

}  // namespace postlens
