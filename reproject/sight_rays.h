// Interface to a ray tracer. Its rays replace samples whose colours the records do not determine.
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

/// The ray that replaces one view's sample in one pixel: a position in the pixel, a lens point and an
/// instant.
struct SightLine {
    int x = 0, y = 0;           ///< pixel, raster px
    glm::dvec2 place{0.5};      ///< position in the pixel, px, where the ray crosses the plane in focus
    glm::dvec2 lens{0};         ///< lens point, lens radii, raster axes
    double light_before = 0.5;  ///< share of the exposure that lies before the ray's instant, 0 to 1
    /// Seed of the ray's random samples of lights and scattering lobes: the index of a set of views, and of a
    /// view in it. Samples are stratified over the views of a set, and independent between sets.
    std::uint32_t set = 0, view = 0;
};

/// The line through the centre of the lens and raster position `at`, in px, at the middle of the exposure.
inline SightLine line_through(const glm::dvec2& at) {
    const glm::dvec2 pixel = glm::floor(at);
    return {.x = static_cast<int>(pixel.x), .y = static_cast<int>(pixel.y), .place = at - pixel};
}

/// Radiance that is added to the image as highlights. Rays leave it out, so that it is not counted twice.
struct LightElsewhere {
    float above = 1;  ///< a node's radiance is clamped to this, per channel
    /// Returns whether the radiance of a shading-tree node is clamped. If empty, no node is clamped.
    /// `path`: the reflections and transmissions by which the node is seen.
    /// `parent_id`, `id`: the object of the last of these, and the object of the node.
    /// `at`: where the pinhole sees a directly visible node, raster px.
    std::function<bool(NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2& at)> of;
    std::vector<std::uint32_t> ids;  ///< ids of all objects for which `of` may return true, ascending
};

/// Identifies all shading-tree nodes of one surface with one path of reflections and transmissions.
struct NodeIdentity {
    NodePath path;
    std::uint32_t parent_id = 0;  ///< the object that reflects or transmits the node; 0 for direct nodes
    std::uint32_t id = 0;
    friend bool operator==(const NodeIdentity&, const NodeIdentity&) = default;
};

/// A ray tracer for the scene from which the records were traced.
class SightRays {
  public:
    SightRays() = default;
    SightRays(const SightRays&) = delete;
    SightRays& operator=(const SightRays&) = delete;
    SightRays(SightRays&&) = delete;
    SightRays& operator=(SightRays&&) = delete;
    virtual ~SightRays() = default;
    /// Writes the scene-linear RGB radiance along line i, without the highlights of `less`, to radiance[i].
    /// Thread-safe. Lines do not affect each other's results.
    virtual void trace(std::span<const SightLine> lines, const LightElsewhere& less,
                       std::span<std::array<float, 3>> radiance) const = 0;
    /// Writes only the radiance that `trace` leaves out as highlights (`less`). Along line i, only nodes with
    /// the identity of[i] count.
    virtual void trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                                 const LightElsewhere& less,
                                 std::span<std::array<float, 3>> radiance) const = 0;
    /// For each line, writes 1/z' of its hit on the object `id`, in 1/m, and the gradient of 1/z' over the
    /// raster, in 1/m per px. Writes 0 for misses. Thread-safe. Only for static scenes.
    virtual void inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                                std::span<glm::dvec3> inverse_z) const = 0;
    /// Returns whether each point of the object `id` has the same radiance for all rays that reach it by
    /// `path`. False if random samples of lights or scattering lobes estimate the radiance.
    [[nodiscard]] virtual bool steady(NodePath path, std::uint32_t id) const = 0;
    /// Returns how many reflected or transmitted patches (planar parts of surfaces) can be drawn in the time
    /// of one ray. If an image square has more per pixel, rays are traced instead.
    /// All SightRays of a PatchField must return the same number.
    [[nodiscard]] virtual std::size_t patches_per_ray() const {
        return std::numeric_limits<std::uint32_t>::max();
    }
};

}  // namespace postlens
