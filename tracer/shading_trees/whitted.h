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
    /// Radius of the lens, m. It decides how glossy surfaces are recorded. A glossy surface reflects or
    /// refracts a lobe (cone) of directions. If the lobe is wider than the lens, as seen from the surface,
    /// every lens point sees about the same mean radiance, so this mean is recorded as part of the surface's
    /// radiance. A narrower lobe is treated like a sharp mirror or glass. With radius 0, every lobe counts as
    /// wider.
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

/// A reflected or refracted ray that arrives at a surface, i.e. the last ray of a path with at least one
/// bounce. It is used to find small bright objects that mirrors or glass show between the samples. For this,
/// the rays that arrive after the same bounces from the four corners of a quadtree cell are combined: a
/// bright object in the space between them is visible in the cell.
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

/// The results of a batch of samples. A sample is one eye ray, and its records describe all surfaces that are
/// recorded for it. The records of sample i have the indices offsets[i] to offsets[i + 1] - 1. They are
/// sorted by layer: layer 0 contains what is visible, and each further layer belongs to one hidden surface.
/// Within a layer, they are sorted by path, the sequence of bounces that leads to the surface.
struct TracedSamples {
    std::vector<Record> records;
    std::vector<std::uint32_t> offsets;
    /// For each record (shaded surface hit), the part of its radiance that has noise, because it was computed
    /// with random rays into glossy lobes or to area lights. The list is empty if no record has noise.
    std::vector<glm::vec3> noisy;
    /// One entry per record. Empty without textures, lights and WhittedSettings::parts.
    std::vector<ColourSource> sources;
    /// For each record (surface hit), the reflected or refracted ray that hit the surface. If an eye ray hit
    /// it, the element is Arrival{}. Such rays are needed because small bright objects may be visible in
    /// mirrors and glass between the traced rays. The list is empty if the scene has no mirrors and glass, or
    /// nothing brighter than white.
    std::vector<Arrival> arrivals;
};

class WhittedTracer {
  public:
    /// Keeps references to `scene`, `camera` and all objects to which `settings` and `hidden` point, so these
    /// must exist as long as the tracer. `hidden` selects which surfaces are recorded although others hide
    /// them. These are shaded as if nothing were in front of them.
    WhittedTracer(const RayScene& scene, const CameraModel& camera, const WhittedSettings& settings,
                  const HiddenLayers& hidden = {});
    ~WhittedTracer();
    WhittedTracer(const WhittedTracer&) = delete;
    WhittedTracer& operator=(const WhittedTracer&) = delete;
    WhittedTracer(WhittedTracer&&) = delete;
    WhittedTracer& operator=(WhittedTracer&&) = delete;

    /// Traces eye rays through raster positions, px, with all their reflections and refractions. Thread-safe.
    /// Is fastest if 16 successive positions are close together.
    /// - `around(i)`: optional; returns earlier samples near positions[i]. Their records contain `w_bend`,
    ///   i.e. how nonlinearly the image of a mirrored or refracted surface moves when the lens point moves.
    ///   Measuring it for the new samples would need additional rays, so the known values are reused where
    ///   possible.
    void trace(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts,
               const std::function<SamplesAround(std::size_t)>& around = {}) const;
    /// Like `trace`, but computes only what decides whether a quadtree cell is subdivided: the visible
    /// surfaces and their radiance. This radiance is an estimate without random noise, because noise would
    /// cause useless subdivision. Hidden surfaces are not found, glossy lobes are not averaged, and the
    /// nonlinear motion of mirror images (`w_bend`) is not measured.
    void trace_steady(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts) const;
    /// Greatest deviation, px, that is taken from neighbouring samples even if they do not agree. The image
    /// of a surface in a mirror or in glass does not move quite linearly when the lens point moves.
    /// Additional rays can measure this deviation. To save them, it is taken from neighbouring samples where
    /// possible. For this, at least one of them must show the same object. A deviation above this limit is
    /// taken only if all of them show this object and have similar deviations.
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
