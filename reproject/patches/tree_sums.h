// Sums the radiance that views (images for one lens point and one instant each) see by reflection and
// transmission. There is one sum for each pixel of a tile and each sequence of reflections and transmissions.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// For each view of a tile, call begin_use. Then, for each path (sequence of reflections and transmissions),
/// call begin_chain and draw the nodes. Then call `add` for each pixel. After all views, call end_views, and
/// then sum_up for each pixel.
///
/// If a view needs a node that was not recorded, the mean of the other views replaces the node. If hardly any
/// view has the node, the radiance seen from the pinhole replaces it.
///
/// Sometimes a node cannot be reprojected, but its children can. For example, the motion with the lens point
/// (matrix W) may be unknown for the far side of a glass ball, but known for the scene behind the ball.
/// Within one object, nodes are therefore also drawn in pixels where their parent node is missing.
class TreeSums {
  public:
    /// `paths` contains all paths (sequences of reflections and transmissions) that may occur, in any order
    /// and possibly repeated. `at` states which pixels of the tile are in use.
    void begin(std::vector<NodePath> paths, const TilePlace& at);
    [[nodiscard]] bool any() const { return !chains_.empty(); }

    /// Starts a view, or one of the two recorded instants of a view. `primary` contains the directly visible
    /// surfaces of the view, and must stay valid until all pixels have been added.
    void begin_use(const PatchMesh& primary_mesh, const PatchMesh* deeper_mesh, const SeenTile& primary);
    /// Prepares the drawing of all surfaces with the path `path`, and stores the pixels that need them in
    /// `wanted`. Returns the cleared tile into which they must be drawn, or null if no pixel needs them or if
    /// `path` was not passed to `begin`. The surfaces of the parent path must be drawn first.
    [[nodiscard]] SeenTile* begin_chain(NodePath path, WantedPixels& wanted);
    /// Returns whether the records determine the reflected and transmitted light of pixel k. Every surface
    /// that is drawn separately there must meet four conditions: the view sees it, no surface with an
    /// uncertain edge may hide it, no edge crosses its quadtree leaf, and its reprojection is accurate (not
    /// Patch::bent).
    [[nodiscard]] bool sure(std::size_t k) const;
    /// Returns the radiance of the reflections and refractions that are drawn separately in pixel k. Requires
    /// sure(k).
    [[nodiscard]] glm::dvec3 light(std::size_t k) const;
    /// Adds the separately drawn nodes of pixel k to the sums.
    void add(std::size_t k, double weight);
    /// Call after the last view, before sum_up.
    void end_views();
    /// Adds the radiance that all views see by reflection and transmission in pixel k to `sum`, the pixel's
    /// radiance times `weight`. Returns the weight of the views that need a surface that is not recorded. It
    /// is reduced if such surfaces are darker in the whole tile than the pixel. If some views miss a
    /// surface's parent, views that see the surface with an inaccurate reprojection (Patch::bent) are
    /// included.
    double sum_up(std::size_t k, double weight, std::array<double, 3>& sum);

  private:
    struct Sums {
        /// Sum of the node's radiance times the weights of views. Includes child nodes that are drawn as part
        /// of it.
        std::array<double, 3> seen{};
        std::array<double, 3>
            instead{};                 ///< weight times the pinhole's radiance, for views that miss the node
        double known = 0, wanted = 0;  ///< weight of the views that have the node, and of those that need it
        double beside = 0;             ///< weight of views that miss the node, but have its descendants
        double alone = 0;              ///< weight of views that have the node, but miss its parent
        double bent = 0;               ///< part of `known` that patches with nonlinear W have drawn
        double total = 0;              ///< weight that the node gets after all views, set by sum_up
    };
    static constexpr std::uint32_t no_chain = 0xFFFFFFFFU;
    using Children = std::array<std::uint32_t, 2>;  ///< for each bounce, an index into chains_, or no_chain
    /// The surfaces of a tile that are seen along one path (sequence of reflections and transmissions from
    /// the eye).
    struct Chain {
        NodePath path;
        std::size_t parent = 0;  ///< index into chains_; its own index if the parent is the primary surface
        std::uint8_t bounce = 0;
        TilePart part;  ///< part of `seen` in which nodes may be drawn; if empty, `seen` is not valid
        Children children{no_chain, no_chain};
        std::unique_ptr<SeenTile> seen;
        bool used = false;       ///< whether anything was added to `sums`; if not, its values are undefined
        std::vector<Sums> sums;  ///< per pixel of the tile
        /// Largest radiance of a surface of this path in the tile. end_views adds that of the surfaces seen
        /// in it, because they may be missing with it.
        float brightest = 0;
        bool any_wanted = false, any_seen = false;
    };
    void add(std::size_t k, double weight, const Children& chains, std::uint8_t children,
             std::uint32_t primary_texel);
    [[nodiscard]] bool sure(std::size_t k, const Children& chains, std::uint8_t children) const;
    [[nodiscard]] glm::dvec3 light(std::size_t k, const Children& chains, std::uint8_t children) const;
    void add_seen(std::size_t k, double weight, Chain& chain, std::uint32_t texel,
                  std::uint32_t primary_texel);
    /// If pixel k of a view lacks the surface of `chain`, but surfaces seen in it are recorded, adds these to
    /// the sums of their own chains. Returns whether there are any.
    bool add_beside(std::size_t k, double weight, const Chain& chain, std::uint32_t primary_texel);
    /// Returns the id of the object that reflects or transmits the surfaces of `chain` in pixel k: the object
    /// of the parent surface if the view sees it, and otherwise that of the nearest ancestor that the view
    /// sees.
    [[nodiscard]] std::uint32_t id_around(const Chain& chain, std::size_t k) const;
    [[nodiscard]] std::uint32_t number_of(NodePath path) const;
    /// Returns the sums of pixel k for the surfaces of `chain`, which share one path. The first call for a
    /// chain in a tile clears all its sums.
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
