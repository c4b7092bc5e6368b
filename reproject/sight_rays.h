// Radiance along lines of sight, for what the records do not show.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>

#include "records/record.h"

namespace postlens {

/// What one view sees at one pixel: a ray from a point of the lens at an instant.
struct SightLine {
    int x = 0, y = 0;           ///< raster px of the pixel
    glm::dvec2 place{0.5};      ///< where in the pixel it goes through the plane in focus, px
    glm::dvec2 lens{0};         ///< in units of the lens's radius, raster axes
    double light_before = 0.5;  ///< of the shutter's light, what has come in before
    /// Number the pixel's lines: those of one set are spread over lights and lobes, sets are independent.
    std::uint32_t set = 0, view = 0;
};

/// Light that comes to the picture by another way, so that no line must meet it.
struct LightElsewhere {
    float above = 1;  ///< radiance of a node: what it has more, in any channel
    /// Which nodes: their chain of bounces, the ids of the last mirror or glass and of what is seen, and,
    /// where that is seen directly, the raster px at which the pinhole would see it. None: no node.
    std::function<bool(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at)> of;
};

/// Who can tell what is seen: a tracer that has the scene.
class SightRays {
  public:
    SightRays() = default;
    SightRays(const SightRays&) = delete;
    SightRays& operator=(const SightRays&) = delete;
    SightRays(SightRays&&) = delete;
    SightRays& operator=(SightRays&&) = delete;
    virtual ~SightRays() = default;
    /// Scene-linear radiance, as many as there are lines. From several threads; the same bits for the same
    /// line, whichever it comes with.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// Whether all lines that meet a surface of this id at one place, by such a chain, have the same radiance
    /// from it, so that what it has above a limit can be told: not where lights or lobes are sampled.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
};

}  // namespace postlens
