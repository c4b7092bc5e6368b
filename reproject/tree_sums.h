// What views show in mirrors and through glass, pixel by pixel of a tile, chain of bounces by chain.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "reproject/patch_raster.h"

namespace postlens {

/// Views of one tile, one after the other: begin_use, drawing into `seen`, add for the pixels; at the end
/// sum_up. Of what views ask for and do not find, because it was never recorded, the others' mean stands in;
/// where hardly any finds it, what the pinhole saw in the mirror's place.
class TreeSums {
  public:
    /// `paths`: the chains that may occur, in any order, also several times.
    void begin(std::vector<NodePath> paths);
    [[nodiscard]] bool any() const { return !chains_.empty(); }

    /// Before what is seen in `primary`, which a use shows, is drawn. Both must stay while it is added.
    void begin_use(const SheetMesh& primary_mesh, const SheetMesh* deeper_mesh, const SeenTile& primary);
    /// Where a chain is drawn; null for one that `begin` was not told of.
    [[nodiscard]] SeenTile* seen(NodePath path);
    /// Takes in pixel k.
    void add(std::size_t k, double weight);
    /// Adds what all views have seen to a pixel's sum. Returns the weight of what was not recorded.
    double sum_up(std::size_t k, std::array<double, 3>& sum);

  private:
    struct Sums {
        std::array<double, 3> seen{};     ///< colours times weights
        std::array<double, 3> instead{};  ///< what stands in for what was not seen
        double known = 0, wanted = 0;     ///< weights
        double scale = 0;                 ///< of what was seen, once all is
    };
    struct Chain {
        NodePath path;
        std::size_t parent = 0;  ///< index into chains_; its own: the primary surface
        std::uint8_t bounce = 0;
        std::unique_ptr<SeenTile> seen;
        std::vector<Sums> sums;
    };
    std::vector<Chain> chains_;  ///< by path, parents first
    std::vector<Chain> spare_;   ///< memory of earlier tiles
    const SheetMesh *primary_mesh_ = nullptr, *deeper_mesh_ = nullptr;
    const SeenTile* primary_ = nullptr;
};

}  // namespace postlens
