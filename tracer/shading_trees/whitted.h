// Whitted's recursive ray tracing [whitted1980] for a batch of point samples.
// Rays with the same number of bounces are traced together. Every surface hit is stored as a record.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "records/record.h"
#include "scene/object_parts.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/bend_around.h"
#include "tracer/shading_trees/hidden_surfaces.h"

namespace postlens {

struct WhittedSettings {
    /// Largest number of surfaces on a path of reflections and refractions: 1 to NodePath::max_bounces + 1.
    int max_depth = 5;
    double min_contribution = 1e-3;  ///< radiance; subtrees that contribute less are not traced
    bool refocus_matrices = true;    ///< compute W of nodes after a bounce (perspective cameras only)
    double bend_radius_m = 0;        ///< lens radius, m, for which `w_bend` is measured; 0: not measured
    /// Radius of the lens, m. A glossy surface reflects or refracts light into a lobe of directions. If the
    /// lobe is wider than the lens, as seen from the surface, every lens point sees about the same mean
    /// radiance over the lobe. Then this mean becomes part of the surface's record. Otherwise, the lobe is
    /// treated like a sharp mirror or glass. If the radius is 0, the means over all lobes are recorded.
    double lens_radius_m = 0;
    /// False for callers that need only positions. Radiances are then undefined.
    bool lit = true;
    const ObjectParts* parts = nullptr;  ///< parts to record in ColourSource::part; may be null
};

/// Numbers of traced rays, by kind of ray. The kinds are those of the Standard Procedural Databases, and two
/// more:
/// - `hidden`: rays that continue behind a surface, to find hidden surfaces
/// - `lens`: rays from lens points other than the centre. They measure `w_bend`, i.e. how nonlinearly a
///   mirror image moves when the lens point moves.
struct RayCounts {
    std::uint64_t eye = 0, eye_hits = 0, reflect = 0, refract = 0, shadow = 0, hidden = 0, lens = 0;
    RayCounts& operator+=(const RayCounts& o) {
        eye += o.eye;
        eye_hits += o.eye_hits;
        reflect += o.reflect;
        refract += o.refract;
        shadow += o.shadow;
        hidden += o.hidden;
        lens += o.lens;
        return *this;
    }
};

/// The last ray of a path that contains at least one reflection or refraction, i.e. the ray that arrives at a
/// surface seen in a mirror or in glass. To find the images of small bright objects there, such objects are
/// searched for between the rays that arrive from the four corners of a quadtree cell.
struct Arrival {
    glm::vec3 from{0}, direction{0};  ///< m; the direction has unit length
    float length = 0;                 ///< m; infinity if it hits nothing
    float throughput = 0;             ///< factor of the node's radiance in the sample, brightest channel
    std::uint32_t parent = 0;         ///< id of the object that reflected or transmitted the ray
};

/// The causes of the colour of a surface point: its texture, the shadows on it, and the part of the object to
/// which it belongs. A quadtree cell is subdivided if one of these causes differs between the cell's corners,
/// even if the colours are equal.
struct ColourSource {
    const Texture* texture = nullptr;  ///< colour texture, or else emission texture; may be null
    glm::vec3 place{0};                ///< texture position of the node (Texture::place)
    std::uint32_t shadows = 0;         ///< bit i is set if a light whose index modulo 32 is i is occluded
    std::uint32_t part = 0;            ///< part of the object (ObjectParts); 0 without WhittedSettings::parts
};

/// The surfaces that are recorded for a batch of samples (eye rays). The records of sample i have the indices
/// offsets[i] to offsets[i + 1] - 1. They are sorted by layer, where 0 is the visible one, and then by path,
/// i.e. the sequence of bounces that leads to the surface.
struct TracedSamples {
    std::vector<Record> records;
    std::vector<std::uint32_t> offsets;
    /// For each record (shaded surface hit), the part of its radiance that has noise, because it was computed
    /// with random rays into glossy lobes or to area lights. The list is empty if no record has noise.
    std::vector<glm::vec3> noisy;
    /// One entry per record. Empty without textures, lights and WhittedSettings::parts.
    std::vector<ColourSource> sources;
    /// For each record, the reflected or refracted ray that hit its surface. If an eye ray hit it, the entry
    /// has default values. The entries are used to find images of small bright objects in mirrors and glass.
    /// The list is empty if the scene has no mirrors and glass, or nothing brighter than white.
    std::vector<Arrival> arrivals;
};

class WhittedTracer {
  public:
    /// The tracer keeps references to `scene`, `camera` and all objects to which `settings` and `hidden`
    /// point, so these must exist as long as the tracer. Hidden surfaces are shaded as if nothing were in
    /// front of them.
    WhittedTracer(const RayScene& scene, const CameraModel& camera, const WhittedSettings& settings,
                  const HiddenLayers& hidden = {});
    ~WhittedTracer();
    WhittedTracer(const WhittedTracer&) = delete;
    WhittedTracer& operator=(const WhittedTracer&) = delete;
    WhittedTracer(WhittedTracer&&) = delete;
    WhittedTracer& operator=(WhittedTracer&&) = delete;

    /// Traces eye rays through raster positions, px, with all their reflections and refractions. Thread-safe.
    /// Is fastest if 16 successive positions are close together.
    /// - `around(i)`: returns earlier samples near positions[i]. Each of their records has a `w_bend`, which
    ///   tells how nonlinearly its image moves when the lens point moves. Additional rays measure it, and
    ///   reusing it saves these rays.
    void trace(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts,
               const std::function<SamplesAround(std::size_t)>& around = {}) const;
    /// Like `trace`, but computes only the visible surfaces and their radiance without sampling noise. These
    /// decide whether a quadtree cell is subdivided. Does not find hidden surfaces, average glossy lobes or
    /// measure `w_bend`.
    void trace_steady(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts) const;
    /// The image of a surface in a mirror or in glass moves nonlinearly when the lens point moves. Additional
    /// rays measure its deviation from linear motion. To save these rays, the deviation is taken from
    /// neighbouring samples if it is at most this value, px. A greater deviation is taken only if the samples
    /// agree about it; otherwise, it is measured.
    static constexpr double little_bend_px = 0.125;

    /// Returns true if a material reflects or transmits, so that rays may continue after their first hit.
    [[nodiscard]] bool has_deeper_nodes() const;
    /// True if `w_bend` (Record) is measured.
    [[nodiscard]] bool measures_bends() const;
    [[nodiscard]] bool has_textures() const;
    /// True if the parts of meshes are recorded (WhittedSettings::parts).
    [[nodiscard]] bool has_parts() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
