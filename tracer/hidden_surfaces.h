// What lies behind what an eye ray meets: the surfaces that the ray would enter one after the other if
// nothing stopped it, for lenses that look past an edge and shutters that see what moves away.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "tracer/film_motion.h"
#include "tracer/lens_reach.h"
#include "tracer/ray_differentials.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// Which hidden surfaces are wanted.
struct HiddenLayers {
    static constexpr int most = 16;
    /// With `motion`: each is shaded like the visible one, and what four things that pass before each other
    /// hide is more than pictures show.
    static constexpr int most_uncovered = 4;
    /// With `lens` and without `motion`: a lens looks behind an edge less far than things move.
    static constexpr int most_seen_past = 3;

    int count = 0;  ///< the first so many, 0 to `most`; counted whether wanted or not
    /// Not null: of these at most `most_uncovered`, and only what may come to light: a surface that every
    /// surface before it moves away from on the film, by more than a quarter of a pixel at some instant.
    const FilmMotion* motion = nullptr;
    /// Not null: of these also, or only, what some point of a lens may see; and inside what mirrors and glass
    /// show likewise.
    const LensReach* lens = nullptr;

    [[nodiscard]] bool all() const { return motion == nullptr && lens == nullptr; }
};

/// An eye ray, or one that a mirror or glass sends on, and the first thing it met.
struct FirstHit {
    glm::dvec3 origin{0}, direction{0};  ///< direction of unit length
    double cos_axis = 1;                 ///< between the eye ray and the optical axis
    glm::dvec2 at{0};                    ///< raster, px
    HitKey key;                          ///< `none`: it met nothing
    SurfacePoint surface;
    NodePath path;                   ///< of what is met; behind a bounce only `HiddenLayers::lens` counts
    std::uint32_t parent = 0;        ///< id of the object where the last bounce was; 0 for none
    RayDifferentials differentials;  ///< at the origin; of rays behind a bounce only

    /// Of what lies on the ray infinitely far away, 1/m, as LensReach counts.
    [[nodiscard]] double inverse_depth_limit() const;
};

/// A surface behind others, or the nothing behind all.
struct HiddenHit {
    std::uint32_t ray = 0;    ///< index into the first hits
    std::uint32_t layer = 0;  ///< how many surfaces are before it
    HitKey key;               ///< `none`: nothing more is there
    SurfacePoint surface;     ///< as the ray meets it: t from its origin
};

/// The hidden surfaces of every ray, each ray's by growing layer. Where a ray leaves an object that it has
/// entered is no surface, unless the object is flat. A ray whose last layer is nothing has that recorded
/// once, and none where it met nothing at all. Adds the rays traced to `rays_spent`. Thread-safe;
/// deterministic.
void find_hidden_surfaces(const RayScene& scene, const HiddenLayers& wanted, std::span<const FirstHit> eye,
                          std::vector<HiddenHit>& out, std::uint64_t& rays_spent);

}  // namespace postlens
