// Interface to a ray tracer. Rays replace those samples of views whose colours the records do not determine.
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

/// The ray that replaces one view's sample in one pixel. It is defined by a position in the pixel, a lens
/// point and an instant.
struct SightLine {
    int x = 0, y = 0;           ///< pixel, raster px
    glm::dvec2 place{0.5};      ///< position in the pixel, px, where the ray crosses the plane in focus
    glm::dvec2 lens{0};         ///< lens point, lens radii, raster axes
    double light_before = 0.5;  ///< share of the exposure that lies before the ray's instant, 0 to 1
    /// Seed of the ray's random samples of lights and scattering lobes. `set`: index of a set of views.
    /// `view`: index of the view in this set. The samples are stratified over the views of a set, and
    /// independent between sets.
    std::uint32_t set = 0, view = 0;
};

/// Radiance that is added to the image as highlights. Rays must leave it out, so that it is not counted
/// twice.
struct LightElsewhere {
    float above = 1;  ///< a node's radiance is clamped to this, per channel
    /// Returns whether the radiance of a shading-tree node is clamped. `path` and `id` describe the node;
    /// `parent_id` is the object that reflects or transmits it. For nodes seen directly, `at` is the raster
    /// position, px, at which the pinhole sees the node. If empty, no node is clamped.
    std::function<bool(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at)> of;
    std::vector<std::uint32_t> ids;  ///< ascending; of all objects for which `of` may return true
};

/// Identifies the nodes of shading trees that show one surface on one path.
struct NodeIdentity {
    NodePath path;
    std::uint32_t parent_id = 0;  ///< the object that reflects or transmits the node; 0 for direct nodes
    std::uint32_t id = 0;
    friend bool operator==(const NodeIdentity&, const NodeIdentity&) = default;
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
    /// Writes the scene-linear RGB radiance of each line to the element of `radiance` with the same index.
    /// Thread-safe. A line's result does not depend on the other lines of the call.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// As `trace`, but writes only the radiance that `trace` leaves out because of `less`, and only that of
    /// nodes that `of` identifies (one element per line).
    virtual void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                                 const LightElsewhere& less,
                                 std::span<std::array<float, 3>> radiance) const = 0;
    /// Writes, for each line that meets the object with this id, 1/z', 1/m, of the point and its gradient
    /// over the raster, 1/m per px; for other lines 0. Not for scenes in which something moves. Thread-safe.
    virtual void inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                                std::span<glm::dvec3> inverse_z) const = 0;
    /// Whether an object sends the same radiance along all rays that reach one of its points by `path`. The
    /// answer is false if lights or lobes are sampled there, because the radiance above a limit then differs
    /// from ray to ray.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
    /// Number of reflected and transmitted patches (planar parts of surfaces) that take as long to draw in a
    /// view as one ray takes to trace. If views would draw more of them per pixel, rays are traced instead.
    /// Must be equal for all rays of a PatchField.
    [[nodiscard]] virtual std::size_t patches_per_ray() const {
        return std::numeric_limits<std::uint32_t>::max();
    }
};

}  // namespace postlens
