// Interface to a ray tracer. A view is the image for one lens point and instant. Where the sample file does
// not determine a view's colour, a traced ray replaces it.
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
    /// Seed of the ray's random numbers. `set` numbers independent sets of rays. Within a set, rays that
    /// differ in `view` have stratified samples of lights and scattering lobes.
    std::uint32_t set = 0, view = 0;
};

/// Returns the ray through the centre of the lens and the raster position `at`, in px. Its instant is the
/// middle of the exposure.
inline SightLine line_through(const glm::dvec2& at) {
    const glm::dvec2 pixel = glm::floor(at);
    return {.x = static_cast<int>(pixel.x), .y = static_cast<int>(pixel.y), .place = at - pixel};
}

/// Bright radiance that traced rays must leave out. The lens's point spread function adds it to the image as
/// highlights, so it would be counted twice.
struct LightElsewhere {
    float above = 1;  ///< a node's radiance is clamped to this, per channel
    /// Returns whether the surface's radiance beyond `above` is left out of the traced radiance. An empty
    /// function leaves nothing out.
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
    /// Computes each ray's scene-linear RGB radiance. Leaves out surfaces' radiance above a limit, as
    /// described by `less`: the lens's point spread function adds it to the image. Thread-safe; rays do not
    /// affect each other's results.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// `trace` leaves out surfaces' radiance above a limit, as described by `less`. Computes only this part
    /// of the radiance: for each ray lines[i], that of the surface of[i].
    virtual void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                                 const LightElsewhere& less,
                                 std::span<std::array<float, 3>> radiance) const = 0;
    /// For each ray, computes the inverse depth of its hit on the object `id`, in 1/m, and the gradient of
    /// inverse depth, in 1/m per px. 0 for a miss. Thread-safe. Only for static scenes.
    virtual void inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                                std::span<glm::dvec3> inverse_z) const = 0;
    /// True if all rays that reach a point of the object by `path`, a sequence of reflections and
    /// transmissions, get the same radiance from it. False if its radiance is estimated from random samples
    /// of lights or scattering lobes.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
    /// A pixel's reflections can be drawn from recorded patches (planar parts of surfaces), or computed by
    /// tracing a ray. Returns the number of patches up to which drawing is faster.
    [[nodiscard]] virtual std::size_t patches_per_ray() const {
        return std::numeric_limits<std::uint32_t>::max();
    }
};

}  // namespace postlens
