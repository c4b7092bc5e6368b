// Interface to a ray tracer that completes the views of a light field. A view is the image for one lens point
// and instant. Where the records of a sample file do not determine its colour, a ray is traced.
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
    /// Seed of the ray's random numbers. `set` is the number of the ray's set, and `view` is the ray's number
    /// within this set. The sets are independent of each other. The samples of lights and scattering lobes
    /// are stratified over the rays of one set.
    std::uint32_t set = 0, view = 0;
};

/// Returns the ray that starts at the centre of the lens and passes through the raster position `at`, in px.
/// The ray's instant is the middle of the exposure.
inline SightLine line_through(const glm::dvec2& at) {
    const glm::dvec2 pixel = glm::floor(at);
    return {.x = static_cast<int>(pixel.x), .y = static_cast<int>(pixel.y), .place = at - pixel};
}

/// Describes bright radiance that must be left out of traced rays. The image gets this radiance separately,
/// as highlights, which the lens's point spread function spreads. If the rays included it too, it would be
/// counted twice.
struct LightElsewhere {
    float above = 1;  ///< a node's radiance is clamped to this, per channel
    /// Returns whether the radiance of a surface above the limit `above` is left out of the traced radiance,
    /// because it is a highlight. If this function is empty, nothing is left out.
    /// - `path`: the reflections and transmissions by which the surface is seen
    /// - `parent_id`: the mirror or glass in which the surface is seen
    /// - `id`: the object to which the surface belongs
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
    /// Traces the rays `lines`, and stores the scene-linear RGB radiance of each ray in `radiance`. The
    /// radiance that `less` selects is left out, because the image gets it separately as highlights.
    /// Thread-safe. The result of a ray does not depend on the other rays.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// Computes the radiance that `trace` leaves out: the part above the limit `less.above`, for the surfaces
    /// that `less` selects. A ray may see several surfaces, directly and in mirrors. For the ray lines[i],
    /// only the light of the surface of[i] is computed.
    virtual void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                                 const LightElsewhere& less,
                                 std::span<std::array<float, 3>> radiance) const = 0;
    /// Stores, for each of the rays `lines`, the inverse depth, in 1/m, at which it hits the object `id`, and
    /// the derivatives of this inverse depth along raster x and y, in 1/m per px. All are 0 if the ray misses
    /// the object. Thread-safe. Only for static scenes.
    virtual void inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                                std::span<glm::dvec3> inverse_z) const = 0;
    /// Returns whether traced rays measure the radiance of the object `id` without noise. There is noise if
    /// lights or scattering lobes are sampled at random. `path` is the sequence of reflections and
    /// transmissions by which the rays reach the object.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
    /// A pixel's reflections can be drawn from recorded patches (planar parts of surfaces), or computed by
    /// tracing a ray. Returns the number of patches up to which drawing is faster.
    [[nodiscard]] virtual std::size_t patches_per_ray() const {
        return std::numeric_limits<std::uint32_t>::max();
    }
};

}  // namespace postlens
