// Sums the radiance that views see by reflection and transmission, for each pixel of a tile and each sequence
// of reflections and transmissions.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Call order for each view of a tile: begin_use; then, for each path, begin_chain and drawing; then `add`
/// for each pixel. After all views: end_views, then sum_up for each pixel.
///
/// If a node that a view needs was not recorded, the mean of the other views replaces it. If hardly any view
/// has the node, the radiance seen from the pinhole replaces it.
///
/// A view may lack a node although it has the node's children. For example, the far side of a glass ball is
/// seen through a caustic and has no valid W, but the scene behind the ball has one. Inside one object, nodes
/// are therefore also drawn where their parent node is needed but missing.
class TreeSums {
  public:
    /// `paths`: all paths that may occur, in any order; repetitions are allowed. `at`: the pixels in use.
    void begin(std::vector<NodePath> paths, const TilePlace& at);
    [[nodiscard]] bool any() const { return !chains_.empty(); }

    /// Starts a view, or one of its two recorded instants. `primary` contains the directly visible surfaces
    /// of the view and must stay valid until all pixels are added.
    void begin_use(const PatchMesh& primary_mesh, const PatchMesh* deeper_mesh, const SeenTile& primary);
    /// Returns the cleared tile into which the shading-tree nodes of `path` are drawn. Draw the nodes of the
    /// parent path first. `wanted` receives the pixels that need a node of `path`. Returns null if no pixel
    /// needs one, or if `path` was not passed to `begin`.
    [[nodiscard]] SeenTile* begin_chain(NodePath path, WantedPixels& wanted);
    /// Whether the records determine the reflected and transmitted light of pixel k. This requires, for every
    /// separately drawn node, that the view sees the node, that no edge crosses its leaf, and that its W is
    /// linear (Patch::bent is false).
    [[nodiscard]] bool sure(std::size_t k) const;
    /// Radiance of the shading-tree nodes of pixel k that are drawn separately from their parents. Requires
    /// sure(k).
    [[nodiscard]] glm::dvec3 light(std::size_t k) const;
    /// Adds to the sums the shading-tree nodes of pixel k that are drawn separately from their parents.
    void add(std::size_t k, double weight);
    /// Call after the last view, before sum_up.
    void end_views();
    /// Adds the shading-tree nodes of all views to `sum`, which is a pixel's radiance times `weight`. Returns
    /// the weight of nodes that are not recorded. Nodes that are dim in the whole tile count less. If views
    /// lack child nodes, nodes that were drawn with a nonlinear W (Patch::bent) count as not recorded as
    /// well.
    double sum_up(std::size_t k, double weight, std::array<double, 3>& sum);

  private:
    struct Sums {
        std::array<double, 3> seen{};  ///< weight times radiance, with child nodes drawn as part of the node
        std::array<double, 3>
            instead{};                 ///< weight times the pinhole's radiance, for views that miss the node
        double known = 0, wanted = 0;  ///< weight of the views that have the node, and of those that need it
        double beside = 0;             ///< weight of views that miss the node, but have its descendants
        double alone = 0;              ///< weight of views that have the node, but miss its parent
        double bent = 0;               ///< part of `known` drawn by patches with nonlinear W
        double total = 0;              ///< weight that the node gets after all views, set by sum_up
    };
    static constexpr std::uint32_t no_chain = 0xFFFFFFFFU;
    using Children = std::array<std::uint32_t, 2>;  ///< per bounce, an index into chains_, or no_chain
    /// The nodes that share one path (sequence of reflections and transmissions from the eye), in the tile.
    struct Chain {
        NodePath path;
        std::size_t parent = 0;  ///< index into chains_; its own index if the parent is the primary surface
        std::uint8_t bounce = 0;
        TilePart part;  ///< part of `seen` in which nodes may be drawn; if empty, `seen` is not valid
        Children children{no_chain, no_chain};
        std::unique_ptr<SeenTile> seen;
        bool used = false;       ///< whether anything was added to `sums`; if not, their values are undefined
        std::vector<Sums> sums;  ///< per pixel of the tile
        /// Largest radiance of a shading-tree node of this path in the tile. From end_views on, it also
        /// includes the radiance of the node's descendants.
        float brightest = 0;
        bool any_wanted = false, any_seen = false;
    };
    void add(std::size_t k, double weight, const Children& chains, std::uint8_t children,
             std::uint32_t primary_texel);
    [[nodiscard]] bool sure(std::size_t k, const Children& chains, std::uint8_t children) const;
    [[nodiscard]] glm::dvec3 light(std::size_t k, const Children& chains, std::uint8_t children) const;
    void add_seen(std::size_t k, double weight, Chain& chain, std::uint32_t texel,
                  std::uint32_t primary_texel);
    /// Adds the recorded descendants of a shading-tree node that is itself missing in pixel k. Returns
    /// whether the node has any descendants there.
    bool add_beside(std::size_t k, double weight, const Chain& chain, std::uint32_t primary_texel);
    /// Id of the object that should reflect or transmit the node of a path in pixel k. This is the object of
    /// the nearest ancestor of the node that the view sees.
    [[nodiscard]] std::uint32_t id_around(const Chain& chain, std::size_t k) const;
    [[nodiscard]] std::uint32_t number_of(NodePath path) const;
    /// The sums of pixel k, which are cleared at the first use of the chain in a tile. The parents of a used
    /// chain are used as well, because nodes are added after their parents.
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
