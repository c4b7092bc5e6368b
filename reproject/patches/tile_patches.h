// Finds, for each tile of the image, the patches (planar parts of surfaces) that views may show there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/motion_marks.h"
#include "reproject/patches/patch_reach.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// The patches of a tile, in drawing order.
struct TilePatches {
    PatchMesh mesh;
    std::vector<PatchReach> reach;
    std::vector<std::uint32_t> motion_class;
};

/// The patches [begin, end) of one path, the sequence of reflections and transmissions from the eye.
struct PatchChain {
    NodePath path;
    std::size_t begin = 0, end = 0;
};

/// All patches that any view of any set may show in a tile.
struct GatheredTile {
    std::vector<TilePatches> primary, deeper;     ///< per instant
    std::vector<std::vector<PatchChain>> chains;  ///< per instant, the chains of `deeper`
    std::vector<NodePath> paths;                  ///< paths of all chains
};

class PatchBins {
  public:
    /// Keeps a reference to `field`.
    PatchBins(const PatchField& field, const MotionMarks& marks);
    /// Number of tiles in a row, and of their rows.
    [[nodiscard]] int columns() const { return columns_; }
    [[nodiscard]] int rows() const { return rows_; }
    /// Whether an instant has patches of reflected and transmitted nodes.
    [[nodiscard]] bool trees() const { return trees_; }
    /// Indices of those patches of an instant that are directly visible, not reflected or transmitted, and
    /// that may appear in a tile in at least one view.
    [[nodiscard]] const std::vector<std::uint32_t>& primary(std::size_t instant, std::size_t tile) const {
        return primary_[instant][tile];
    }
    /// Copies the patches of a tile.
    void gather(std::size_t tile, GatheredTile& out) const;

  private:
    using Bins =
        std::vector<std::vector<std::uint32_t>>;  ///< per tile, patches that some view may show there
    /// For each tile, the patches that reach it in some view. They are sorted by path, so that parents come
    /// first. Within a path the nearest come first, so that hidden pixels fail the depth test early.
    [[nodiscard]] Bins sorted(const PatchMesh& mesh, std::size_t instant, const MotionMarks& marks) const;
    /// Collects all paths that may occur in the tile. Views that lack a path then count as unknown.
    void gather_chains(std::size_t tile, GatheredTile& out) const;
    /// Copies a tile's patches to contiguous memory, because every view reads all patches of the tile.
    void gather(const PatchMesh& mesh, const std::vector<std::uint32_t>& bin, TilePatches& out) const;

    const PatchField& field_;
    int columns_, rows_;
    glm::dvec2 farthest_px_{0};     ///< per axis, largest lens point, as LensShift::lens_px
    double farthest_shift_px_ = 0;  ///< largest shift of a point at infinity in a view, px
    bool trees_ = false;
    std::vector<Bins> primary_, deeper_;  ///< per instant
};

}  // namespace postlens
