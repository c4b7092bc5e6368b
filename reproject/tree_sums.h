// What views show in mirrors and through glass, pixel by pixel of a tile, chain of bounces by chain.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "reproject/patch_raster.h"

namespace postlens {

/// Views of one tile, one after the other: begin_use, begin_chain and drawing chain by chain, add for the
/// pixels; at the end sum_up. Of what views ask for and do not find, because it was never recorded, the
/// others' mean stands in; where hardly any finds it, what the pinhole saw in the mirror's place.
///
/// A chain that a view does not find may still show what goes on from it: the far side of a glass ball is
/// seen through a caustic, which no W describes, and what shines through it is not. What lies within one
/// object is therefore also drawn where the part before it is wanted, but missing.
class TreeSums {
  public:
    /// `paths`: the chains that may occur, in any order, also several times. `at` has the pixels in use.
    void begin(std::vector<NodePath> paths, const TilePlace& at);
    [[nodiscard]] bool any() const { return !chains_.empty(); }

    /// Before what is seen in `primary`, which a use shows, is drawn. Both must stay while it is added.
    void begin_use(const PatchMesh& primary_mesh, const PatchMesh* deeper_mesh, const SeenTile& primary);
    /// Where a chain is drawn, once its parent is: made ready for the use, with where it is wanted in
    /// `wanted`. Null where no pixel wants it, and for a chain that `begin` was not told of.
    [[nodiscard]] SeenTile* begin_chain(NodePath path, WantedPixels& wanted);
    /// Whether the records are sure of all that is drawn for itself in pixel k: every chain is seen, nowhere
    /// at an edge, and by no bent patch.
    [[nodiscard]] bool sure(std::size_t k) const;
    /// What the view shows so in pixel k, where it is sure.
    [[nodiscard]] glm::dvec3 light(std::size_t k) const;
    /// Takes in pixel k: what is drawn for itself there.
    void add(std::size_t k, double weight);
    /// Before the pixels are summed up, once all views are in.
    void end_views();
    /// The weight of what was not recorded, as far as it may matter: what is dim in the whole tile is counted
    /// as so much less than the pixel. `guessed`: of views where hardly any other sees the same.
    struct Unknown {
        double all = 0, guessed = 0;
    };
    /// Adds what all views have seen to a pixel's sum, of colours times weights, `weight` together. Where
    /// views miss what goes on, what bent patches show is as unknown.
    Unknown sum_up(std::size_t k, double weight, std::array<double, 3>& sum);

  private:
    struct Sums {
        std::array<double, 3> seen{};     ///< colours times weights, with what moves with it
        std::array<double, 3> instead{};  ///< what stands in for what was not seen
        double known = 0, wanted = 0;     ///< weights
        double beside = 0;                ///< of views that do not find it, but what goes on from it
        double alone = 0;                 ///< of `known`: in views that do not find its parent
        double bent = 0;                  ///< of `known`: drawn by patches that are bent
        double total = 0;                 ///< all that is wanted of it, once all views are in
    };
    static constexpr std::uint32_t no_chain = 0xFFFFFFFFU;
    using Children = std::array<std::uint32_t, 2>;  ///< by bounce: an index into chains_, or no_chain
    struct Chain {
        NodePath path;
        std::size_t parent = 0;  ///< index into chains_; its own: the primary surface
        std::uint8_t bounce = 0;
        TilePart part;  ///< of `seen` where something may be drawn; empty: `seen` is out of date
        Children children{no_chain, no_chain};
        std::unique_ptr<SeenTile> seen;
        std::vector<Sums> sums;
        /// Greatest radiance of it that was seen in the tile; then with all that goes on from it.
        float brightest = 0;
        bool any_wanted = false, any_seen = false;
    };
    void add(std::size_t k, double weight, const Children& chains, std::uint8_t children,
             std::uint32_t primary_texel);
    [[nodiscard]] bool sure(std::size_t k, const Children& chains, std::uint8_t children) const;
    [[nodiscard]] glm::dvec3 light(std::size_t k, const Children& chains, std::uint8_t children) const;
    void add_seen(std::size_t k, double weight, Chain& chain, std::uint32_t texel,
                  std::uint32_t primary_texel);
    /// What goes on from a chain that is not seen in pixel k. Whether anything does.
    bool add_beside(std::size_t k, double weight, const Chain& chain, std::uint32_t primary_texel);
    /// The id of what a chain is wanted in.
    [[nodiscard]] std::uint32_t id_around(const Chain& chain, std::size_t k) const;
    [[nodiscard]] std::uint32_t number_of(NodePath path) const;

    Children first_{no_chain, no_chain};  ///< chains of one bounce
    std::vector<Chain> chains_;           ///< by path, parents first
    std::vector<Chain> spare_;            ///< memory of earlier tiles
    const PatchMesh *primary_mesh_ = nullptr, *deeper_mesh_ = nullptr;
    const SeenTile* primary_ = nullptr;
    TilePlace at_;
    TilePart primary_part_;  ///< where something is seen in what it shows
};

}  // namespace postlens
