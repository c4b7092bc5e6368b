// Computes the reflected and refracted light in each pixel, as the mean over all views (images for one lens
// point and instant). Surfaces seen by different sequences of reflections and transmissions have separate
// sums.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Order of calls for a tile:
/// - for each view: begin_use; then, for each path (sequence of reflections and transmissions), begin_chain
///   and drawing; then `add` for each pixel;
/// - after all views: end_views; then sum_up for each pixel.
///
/// The mean of the other views replaces a node that was not recorded. If hardly any view has the node, the
/// radiance seen from the pinhole replaces it.
///
/// Sometimes a node cannot be reprojected, but its children can: the far side of a glass ball may have an
/// unknown W (motion with the lens point), but the scene behind the ball a known one. So within one object,
/// nodes are also drawn where their parent is missing.
class TreeSums {
  public:
    /// Begins a tile (a square of the image), which lies at `at`. `paths` contains all sequences of
    /// reflections and transmissions by which surfaces may be seen in the tile. They may be in any order, and
    /// a sequence may occur several times.
    void begin(std::vector<NodePath> paths, const TilePlace& at);
    [[nodiscard]] bool any() const { return !chains_.empty(); }

    /// Begins a view (image for one lens point and instant). If a view blends the records of two instants,
    /// call this function once for each of them.
    /// - `primary_mesh`: surfaces that are seen directly
    /// - `deeper_mesh`: surfaces seen by reflection or transmission; may be null
    /// - `primary`: the surface that each pixel shows directly; must stay valid until all pixels are added
    void begin_use(const PatchMesh& primary_mesh, const PatchMesh* deeper_mesh, const SeenTile& primary);
    /// Prepares to draw the surfaces that are seen by `path`, a sequence of reflections and transmissions.
    /// Sets `wanted` to the pixels that may show them. Returns the tile into which the caller must draw, or
    /// null if there are no such pixels. Call this for shorter paths first, because a mirror must be drawn
    /// before the surfaces seen in it.
    [[nodiscard]] SeenTile* begin_chain(NodePath path, WantedPixels& wanted);
    /// Returns whether the recorded surfaces determine the reflected and refracted light of pixel k. This is
    /// so if, for each surface that the pixel shows by reflection or refraction, a colour is recorded, no
    /// edge crosses the recorded colour's cell, and the surface is reprojected accurately.
    [[nodiscard]] bool sure(std::size_t k) const;
    /// Returns the radiance that reaches the eye through pixel k from those reflections and refractions that
    /// are drawn as separate surfaces. Call only if sure(k) is true, because otherwise some of these surfaces
    /// may be missing.
    [[nodiscard]] glm::dvec3 light(std::size_t k) const;
    void add(std::size_t k, double weight);
    /// Call after the last view, before sum_up.
    void end_views();
    /// Adds the light of reflections and refractions in pixel k to `sum`, which holds the pixel's radiance
    /// times `weight`. `weight` is the total weight of the views whose colour comes from the records.
    ///
    /// Returns the total weight of those views in which a reflection or refraction is missing. It is reduced
    /// if the missing light is darker than the pixel.
    double sum_up(std::size_t k, double weight, std::array<double, 3>& sum);

  private:
    struct Sums {
        /// Radiance of this reflected or refracted surface times the weight of the view, summed over the
        /// views that show it in the pixel. Further reflections are included only if they are not drawn as
        /// separate surfaces.
        std::array<double, 3> seen{};
        std::array<double, 3>
            instead{};  ///< weight times the pinhole's radiance, for views that lack the surface
        double known = 0,
               wanted = 0;  ///< weight of the views that show the surface, and of those that need it
        double beside = 0;  ///< weight of views that lack the surface, but show surfaces seen in it
        double alone = 0;   ///< weight of views that show the surface, but lack its mirror or glass
        double bent = 0;    ///< weight of views that show the surface inaccurately (Patch::bent)
        double total = 0;   ///< weight of the surface after all views, set by sum_up
    };
    static constexpr std::uint32_t no_chain = 0xFFFFFFFFU;
    using Children = std::array<std::uint32_t, 2>;  ///< for each bounce, an index into chains_, or no_chain
    struct Chain {
        NodePath path;
        std::size_t parent = 0;  ///< index into chains_; its own index if the parent is the primary surface
        std::uint8_t bounce = 0;
        TilePart part;  ///< part of `seen` in which nodes may be drawn; if empty, `seen` is not valid
        Children children{no_chain, no_chain};
        std::unique_ptr<SeenTile> seen;
        bool used = false;       ///< whether anything was added to `sums`; if not, its values are undefined
        std::vector<Sums> sums;  ///< per pixel of the tile
        float brightest = 0;
        bool any_wanted = false, any_seen = false;
    };
    void add(std::size_t k, double weight, const Children& chains, std::uint8_t children,
             std::uint32_t primary_texel);
    [[nodiscard]] bool sure(std::size_t k, const Children& chains, std::uint8_t children) const;
    [[nodiscard]] glm::dvec3 light(std::size_t k, const Children& chains, std::uint8_t children) const;
    void add_seen(std::size_t k, double weight, Chain& chain, std::uint32_t texel,
                  std::uint32_t primary_texel);
    /// Call for pixel k of a view if the surface of `chain`, itself a mirror or glass, should appear there
    /// but is not recorded. Adds the recorded light of the surfaces that are seen in it, times the view's
    /// `weight`. Returns false if there are none.
    bool add_beside(std::size_t k, double weight, const Chain& chain, std::uint32_t primary_texel);
    /// Returns the id of the mirror or glass in which pixel k shows the surface of `chain`. After several
    /// reflections in succession, it is the last mirror that is recorded in this pixel, or else the directly
    /// visible object.
    [[nodiscard]] std::uint32_t id_around(const Chain& chain, std::size_t k) const;
    [[nodiscard]] std::uint32_t number_of(NodePath path) const;
    [[nodiscard]] Sums& sums_of(Chain& chain, std::size_t k);

    Children first_{no_chain, no_chain};  ///< chains of one bounce
    std::vector<Chain> chains_;           ///< sorted by path, parents first
    std::vector<std::size_t> used_;       ///< indices of used chains, set by end_views
    std::vector<Chain> spare_;            ///< memory of earlier tiles
    const PatchMesh *primary_mesh_ = nullptr, *deeper_mesh_ = nullptr;
    const SeenTile* primary_ = nullptr;
    TilePlace at_;
    TilePart primary_part_;  ///< bounding box of the pixels with separately drawn child nodes
};

}  // namespace postlens
