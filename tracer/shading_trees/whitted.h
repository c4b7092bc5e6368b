// Whitted's recursive ray tracing [whitted1980], breadth first for a batch of point samples: all rays after
// the same number of bounces are traced in packets. Every node of every shading tree becomes a record.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/bend_around.h"
#include "tracer/shading_trees/hidden_surfaces.h"

namespace postlens {

struct WhittedSettings {
    int max_depth = 5;  ///< nodes along a path, the primary node counts 1; 1 to NodePath::max_bounces + 1
    double min_contribution = 1e-3;  ///< radiance; subtrees that can contribute only less are not traced
    bool refocus_matrices = true;    ///< computes W of nodes after a bounce (perspective cameras only)
    double bend_radius_m = 0;        ///< lens radius for which nonlinear W is measured; 0: not measured
    /// Lens radius, m. A rough surface whose lobe is wider than this lens (lobe_is_wide) is recorded with the
    /// mean radiance over its lobe, and other surfaces with the radiance of the exact direction. 0: all lobes
    /// are averaged.
    double lens_radius_m = 0;
    bool lit = true;  ///< false: ignores lights, for callers that only need positions
};

/// Number of rays traced, in the categories of the Standard Procedural Databases. `hidden`: rays continued
/// behind a surface. `lens`: rays from lens points, which measure nonlinear W (`w_bend`).
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

/// The texture and the shadows that determine a record's colour. With these, cells are subdivided at edges of
/// textures and shadows even if the colours at their corners are equal.
struct ColourSource {
    const Texture* texture = nullptr;  ///< colour texture, else emission texture; null: none
    glm::vec3 place{0};                ///< texture position of the node (Texture::place)
    std::uint32_t shadows = 0;         ///< bit i: a light of index i modulo 32 is occluded
};

/// The records of a batch of samples. Sample i has the records [offsets[i], offsets[i + 1]), sorted by layer
/// and then by path, the primary node first.
struct TracedSamples {
    std::vector<Record> records;
    std::vector<std::uint32_t> offsets;
    /// Per record: the part of r, g, b that has sampling noise, that is radiance from lobes and, in
    /// penumbrae, the difference from half of the unshadowed light. Empty if no record has such a part.
    std::vector<glm::vec3> noisy;
    /// Per record; empty where the scene has neither textures nor lights.
    std::vector<ColourSource> sources;
};

class WhittedTracer {
  public:
    /// Keeps references to scene, camera and the motion in `hidden`. A hidden surface is shaded as if nothing
    /// were in front of it. Visible surfaces have the same bits with and without hidden ones.
    WhittedTracer(const RayScene& scene, const CameraModel& camera, const WhittedSettings& settings,
                  const HiddenLayers& hidden = {});
    ~WhittedTracer();
    WhittedTracer(const WhittedTracer&) = delete;
    WhittedTracer& operator=(const WhittedTracer&) = delete;
    WhittedTracer(WhittedTracer&&) = delete;
    WhittedTracer& operator=(WhittedTracer&&) = delete;

    /// Traces point samples at raster positions, px; fastest if groups of 16 lie close together. Thread-safe.
    /// `around(i)`, if given, returns samples within a pixel of positions[i] that were traced before. The
    /// nonlinear W of a node is taken from these samples if `bend_around` finds that it is small
    /// (little_bend_px), and measured otherwise.
    void trace(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts,
               const std::function<SamplesAround(std::size_t)>& around = {}) const;
    /// Error of a node's image position at the rim of the lens, px, below which the node's nonlinear W counts
    /// as small.
    static constexpr double little_bend_px = 0.125;

    /// True if a material reflects or transmits, so that there can be nodes after a bounce.
    [[nodiscard]] bool has_deeper_nodes() const;
    /// True if nonlinear W is measured.
    [[nodiscard]] bool measures_bends() const;
    /// True if a material has a texture.
    [[nodiscard]] bool has_textures() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
