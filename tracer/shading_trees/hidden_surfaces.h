// Finds hidden surfaces: those that an eye ray would hit next if it passed through its first hit.
// A wide lens sees them past edges, and motion uncovers them during the exposure.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/object_parts.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/shading_trees/lens_reach.h"
#include "tracer/shading_trees/ray_differentials.h"

namespace postlens {

/// Which hidden surfaces find_hidden_surfaces returns.
struct HiddenLayers {
    static constexpr int most = 16;
    /// Largest number of hidden surfaces per eye ray that are recorded because motion may reveal them.
    /// Further surfaces lie behind all of these, so they are rarely visible.
    static constexpr int most_uncovered = 4;
    /// Largest number of hidden surfaces that are recorded behind the first hit of a ray if only the lens may
    /// reveal them, and not motion. From some lens points, they are visible past the edge of the first
    /// surface.
    static constexpr int most_seen_past = 3;
    /// Hidden surfaces appear beside the edges of nearer surfaces when the lens point or the instant changes.
    /// If such a visible strip is at most this wide, px, the hidden surface counts as invisible and is not
    /// recorded. The error is small, because the strip covers at most a quarter of a pixel, and a pixel of
    /// the image is the mean of four or more samples.
    static constexpr double invisible_px = 0.25;

    int count = 0;  ///< number of surfaces examined behind the first hit, 0 to `most`
    /// The motion of the camera and of objects on the raster; may be null. If given, find_hidden_surfaces
    /// returns the hidden surfaces that this motion may reveal, at most `most_uncovered` per ray. If neither
    /// `motion` nor `lens` (below) is given, it returns all hidden surfaces, whether anything reveals them or
    /// not.
    const FilmMotion* motion = nullptr;
    /// Tells which hidden surfaces a point of the lens may see, directly, in mirrors or through glass; may be
    /// null. If given, find_hidden_surfaces returns these surfaces. If `motion` is given, too, it returns the
    /// surfaces that the lens or the motion may reveal.
    const LensReach* lens = nullptr;
    /// The connected parts of each object, such as the leaves of a tree. A ray that enters one leaf must
    /// leave this leaf, so the front and back of a leaf are not counted as two surfaces. Null if every object
    /// is a single part.
    const ObjectParts* parts = nullptr;
    double same_place_px = invisible_px;  ///< only for `motion`; `lens` has its own

    [[nodiscard]] bool all() const { return motion == nullptr && lens == nullptr; }
};

/// A ray and its first hit. It may be an eye ray or a reflected or refracted ray. The surfaces behind the
/// first hit on the same ray are the hidden surfaces to be found.
struct FirstHit {
    glm::dvec3 origin{0}, direction{0};  ///< direction of unit length
    double cos_axis = 1;                 ///< cosine of the angle between the eye ray and the optical axis
    glm::dvec2 at{0};                    ///< raster position of the eye ray, px
    HitKey key;                          ///< `none` if the ray hit nothing
    SurfacePoint surface;
    NodePath path;                   ///< path of the hit; after a bounce, only `HiddenLayers::lens` is used
    std::uint32_t parent = 0;        ///< id of the object of the last bounce; 0 if none
    RayDifferentials differentials;  ///< at the origin of the ray; set only after a bounce

    /// Returns the inverse depth, 1/m, at which the camera sees infinitely distant points along this ray. It
    /// is 0 for an eye ray. After a bounce at a curved mirror, it is not 0, because the mirror shows distant
    /// points at a finite depth.
    [[nodiscard]] double inverse_depth_limit() const;
};

/// A surface that an eye ray would hit behind its first hit, or the background that the ray would reach
/// behind all surfaces.
struct HiddenHit {
    std::uint32_t ray = 0;    ///< index into the first hits
    std::uint32_t layer = 0;  ///< number of surfaces in front of it
    HitKey key;               ///< `none` if the ray hits nothing more
    SurfacePoint surface;     ///< t is measured from the ray's origin
};

/// Finds the surfaces that are hidden behind the first hits of rays. `eye` holds these rays with their first
/// hits. The result `out` is sorted by ray, and for each ray by layer, i.e. by the number of surfaces in
/// front. If the background behind the last surface may be revealed, too, it is added as a hit without a
/// valid key. Adds the number of traced rays to `rays_spent`. Thread-safe and deterministic.
void find_hidden_surfaces(const RayScene& scene, const HiddenLayers& wanted, std::span<const FirstHit> eye,
                          std::vector<HiddenHit>& out, std::uint64_t& rays_spent);

}  // namespace postlens
