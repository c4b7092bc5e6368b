// For each tile of the image, finds the patches (planar parts of surfaces) that may appear there in views
// from any lens point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/motion_marks.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patch_reach.h"
#include "reproject/patches/patch_sweep.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// The patches (planar parts of surfaces) of a tile, in drawing order.
struct TilePatches {
    PatchMesh mesh;
    std::vector<PatchReach> reach;
    std::vector<std::uint32_t> motion_class;
};

/// The patches [begin, end) of a tile. They share one path (sequence of reflections and transmissions from
/// the eye).
struct PatchChain {
    NodePath path;
    std::size_t begin = 0, end = 0;
};

/// All patches that any view of any set may show in a rectangle of a tile.
struct GatheredTile {
    std::vector<TilePatches> primary, deeper;     ///< per instant
    std::vector<std::vector<PatchChain>> chains;  ///< for each instant, the chains of `deeper`
    std::vector<NodePath> paths;                  ///< paths of all chains
};

class PatchBins {
  public:
    /// Keeps a reference to `field`.
    PatchBins(const PatchField& field, const MotionMarks& marks);
    [[nodiscard]] int columns() const { return columns_; }
    [[nodiscard]] int rows() const { return rows_; }
    /// Returns whether any instant has patches of reflected and transmitted nodes.
    [[nodiscard]] bool trees() const { return trees_; }
    /// Returns the indices of those directly visible patches of an instant that may appear in a tile in at
    /// least one view.
    [[nodiscard]] const std::vector<std::uint32_t>& primary(std::size_t instant, std::size_t tile) const {
        return primary_[instant][tile].patches;
    }
    /// Copies the directly visible patches of a tile that may appear in the given rectangle to `out`. Empties
    /// the lists of reflected and transmitted patches, which gather_chains fills.
    void gather(std::size_t tile, const TilePart& rect, GatheredTile& out) const;
    /// Returns whether more than `most` reflected and transmitted patches of any one instant may appear in a
    /// rectangle of a tile.
    [[nodiscard]] bool has_more_deeper(std::size_t tile, const TilePart& rect, std::size_t most) const;
    /// Copies the reflected and transmitted patches that may appear in a rectangle of a tile. Must be called
    /// after `gather`. Paths (sequences of reflections and transmissions) without patches in the rectangle
    /// are listed, too, so that views that need a surface with such a path find that it is not recorded.
    void gather_chains(std::size_t tile, const TilePart& rect, GatheredTile& out) const;

  private:
    /// The patches that may appear in a tile in some view. For each patch, `pixels` states in which part of
    /// the tile it may appear.
    struct Bin {
        struct Pixels {
            std::uint8_t x_first, x_last, y_first, y_last;
            [[nodiscard]] bool meet(const TilePart& r) const {
                return x_first < r.x_end && x_last >= r.x_begin && y_first < r.y_end && y_last >= r.y_begin;
            }
        };
        std::vector<std::uint32_t> patches;
        std::vector<Pixels> pixels;
        std::vector<PatchChain> chains;  ///< runs of `patches`, in ascending order of their paths
    };
    using Bins = std::vector<Bin>;  ///< per tile
    /// Returns, for each tile, the patches that may appear in it in some view. They are sorted by path
    /// (sequence of reflections and transmissions), so that a reflecting surface precedes its reflections.
    /// Patches with equal paths are sorted from near to far, so that hidden pixels fail the depth test early.
    [[nodiscard]] Bins sorted(const PatchMesh& mesh, std::size_t instant, const MotionMarks& marks,
                              const PatchSweep& sweep) const;
    /// Removes all patches from `out`.
    static void begin(const PatchMesh& mesh, TilePatches& out);
    /// Appends a patch. Patches are copied to contiguous memory because every view reads all patches of the
    /// rectangle.
    void add(const PatchMesh& mesh, std::uint32_t patch, TilePatches& out) const;

    const PatchField& field_;
    int columns_, rows_;
    glm::dvec2 farthest_px_{0};     ///< for each axis, the largest |LensShift::lens_px|
    double farthest_shift_px_ = 0;  ///< largest shift of a point at infinity in a view, px
    bool trees_ = false;
    std::vector<Bins> primary_, deeper_;  ///< per instant
};

}  // namespace postlens
