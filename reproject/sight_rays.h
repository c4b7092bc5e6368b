// Interface to a ray tracer. Its rays replace pixels of single views (images for one lens point and instant)
// whose colours the records do not determine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "records/record.h"

namespace postlens {

/// A ray through one pixel and one lens point at one instant. Its radiance is the colour of the pixel in the
/// image that this lens point sees.
struct SightLine {
    int x = 0, y = 0;           ///< pixel, raster px
    glm::dvec2 place{0.5};      ///< position in the pixel, px, where the ray crosses the plane in focus
    glm::dvec2 lens{0};         ///< lens point, lens radii, raster axes
    double light_before = 0.5;  ///< share of the exposure that lies before the ray's instant, 0 to 1
    /// Seed of the ray's random numbers. Rays of the same `set` with different `view` have stratified samples
    /// of lights and scattering lobes. Rays of different sets are independent.
    std::uint32_t set = 0, view = 0;
};

/// Returns the ray through the centre of the lens and raster position `at`, in px, at the middle of the
/// exposure.
inline SightLine line_through(const glm::dvec2& at) {
    const glm::dvec2 pixel = glm::floor(at);
    return {.x = static_cast<int>(pixel.x), .y = static_cast<int>(pixel.y), .place = at - pixel};
}

/// Bright radiance that traced rays must leave out. The lens's point spread function adds it to the image as
/// highlights, so it would be counted twice.
struct LightElsewhere {
    float above = 1;  ///< a node's radiance is clamped to this, per channel
    /// Returns whether radiance beyond the limit `above` is left out of the traced radiance. If not set,
    /// nothing is left out.
    /// - `path`: the reflections and transmissions by which the surface is seen
    /// - `parent_id`: the mirror or glass in which the surface is seen
    /// - `at`: raster position, in px, of a directly visible surface
    std::function<bool(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at)> of;
    std::vector<std::uint32_t> ids;  ///< ids of all objects for which `of` may return true, ascending
};

/// Identifies a surface together with the sequence of reflections and transmissions by which it is seen.
struct NodeIdentity {
    NodePath path;
    std::uint32_t parent_id = 0;  ///< the object that reflects or transmits the node; 0 for direct nodes
    std::uint32_t id = 0;
    friend bool operator==(const NodeIdentity&, const NodeIdentity&) = default;
};

/// A ray tracer for the scene from which the sample file was traced.
class SightRays {
  public:
    SightRays() = default;
    SightRays(const SightRays&) = delete;
    SightRays& operator=(const SightRays&) = delete;
    SightRays(SightRays&&) = delete;
    SightRays& operator=(SightRays&&) = delete;
    virtual ~SightRays() = default;
    /// Computes each ray's scene-linear RGB radiance. Leaves out the bright light that `less` describes,
    /// because the image gets this light from the lens's point spread function. Thread-safe; rays do not
    /// affect each other's results.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// Computes, for ray i, only the bright light of surface of[i] that `less` describes, i.e. the light that
    /// `trace` leaves out.
    virtual void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                                 const LightElsewhere& less,
                                 std::span<std::array<float, 3>> radiance) const = 0;
    /// For each ray, computes the inverse depth of its hit on the object `id`, in 1/m, and the gradient of
    /// inverse depth, in 1/m per px. 0 for a miss. Thread-safe. Only for static scenes.
    virtual void inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                                std::span<glm::dvec3> inverse_z) const = 0;
    /// True if a point of the object has the same radiance for all rays that reach it by `path`. False if the
    /// radiance is estimated from random samples of lights or scattering lobes.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
    /// Returns how many reflected or transmitted patches (planar parts of surfaces) can be drawn in the time
    /// that one ray takes. If a pixel would need more patches, rays are traced instead.
    [[nodiscard]] virtual std::size_t patches_per_ray() const {
        return std::numeric_limits<std::uint32_t>::max();
    }
};

}  // namespace postlens
