// Interface to a ray tracer, which finds the radiance along rays that replace view samples.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>

#include "records/record.h"

namespace postlens {

/// The ray of one view sample: through a position in the pixel, from a lens point, at an instant.
struct SightLine {
    int x = 0, y = 0;           ///< pixel, raster px
    glm::dvec2 place{0.5};      ///< position in the pixel, px, where the ray crosses the plane in focus
    glm::dvec2 lens{0};         ///< lens point, lens radii, raster axes
    double light_before = 0.5;  ///< share of the exposure that is over at the ray's instant, 0 to 1
    /// Seed of the ray's samples of lights and lobes. They are stratified over the views of one set and
    /// independent between sets.
    std::uint32_t set = 0, view = 0;
};

/// Radiance that is added to the image as highlights, so that rays must not count it again.
struct LightElsewhere {
    float above = 1;  ///< a node's radiance is clamped to this, per channel
    /// Whether a node is clamped. Arguments: its path; the id of the reflecting or transmitting object before
    /// it, and its own id; for a primary node the raster position, px, at which the pinhole sees it. None: no
    /// node is clamped.
    std::function<bool(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at)> of;
};

/// A ray tracer that has the scene.
class SightRays {
  public:
    SightRays() = default;
    SightRays(const SightRays&) = delete;
    SightRays& operator=(const SightRays&) = delete;
    SightRays(SightRays&&) = delete;
    SightRays& operator=(SightRays&&) = delete;
    virtual ~SightRays() = default;
    /// Writes the scene-linear RGB radiance of each line to `radiance`, which has as many elements.
    /// Thread-safe. A line's result does not depend on the other lines of the call.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// Whether all rays that reach a point of an object by `path` get the same radiance from it. False if
    /// lights or lobes are sampled there: the radiance above a limit then differs from ray to ray.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
};

}  // namespace postlens
