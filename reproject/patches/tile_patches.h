// For each tile of the image, finds the patches (planar parts of surfaces) that any lens point may see in it,
// at any instant.
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

/// The patches (planar parts of surfaces) that may be visible in a tile, in drawing order.
struct TilePatches {
    PatchMesh mesh;
    std::vector<PatchReach> reach;
    std::vector<std::uint32_t> motion_class;
};

/// A group of patches (parts of surfaces) that are seen by the same sequence of reflections and
/// transmissions, `path`. Each tile (square of the image) has a list of patches, sorted by this sequence. The
/// group is the range of elements [begin, end) of this list.
struct PatchChain {
    NodePath path;
    std::size_t begin = 0, end = 0;
};

/// The patches (parts of surfaces) that may appear in a rectangular part of a tile, seen from any lens point.
/// `primary` holds those that are seen directly, and `deeper` those that are seen by reflection or
/// transmission. Each of these lists has one element for each recorded instant.
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
    /// Returns whether any recorded instant has reflected or transmitted surfaces.
    [[nodiscard]] bool trees() const { return trees_; }
    /// Returns the indices of the patches (planar parts of surfaces) that some view may show in the tile, a
    /// square of the image. Only patches that are directly visible are returned, as recorded at the instant
    /// with the index `instant`.
    [[nodiscard]] const std::vector<std::uint32_t>& primary(std::size_t instant, std::size_t tile) const {
        return primary_[instant][tile].patches;
    }
    /// Copies to `out` the directly visible patches (planar parts of surfaces) that may appear in the
    /// rectangle `rect` of the tile, from any lens point and at any instant. Patches seen by reflection or
    /// transmission are added by gather_chains.
    void gather(std::size_t tile, const TilePart& rect, GatheredTile& out) const;
    /// Returns whether more than `most` patches (planar parts of surfaces) seen by reflection or transmission
    /// may appear in the rectangle `rect` of the tile at any one of the recorded instants.
    [[nodiscard]] bool has_more_deeper(std::size_t tile, const TilePart& rect, std::size_t most) const;
    /// Adds to `out` the patches (planar parts of surfaces) that are seen by reflection or transmission, and
    /// may appear in the rectangle `rect` of the tile. They are grouped by their sequence of reflections and
    /// transmissions. A group may be empty.
    void gather_chains(std::size_t tile, const TilePart& rect, GatheredTile& out) const;

  private:
    /// Lists the patches (planar parts of surfaces) that may appear in one tile of the image, from any lens
    /// point and at any instant. `pixels` has as many elements as `patches`: for each patch, the rectangle of
    /// pixels of the tile in which the patch may appear.
    struct Bin {
        struct Pixels {
            std::uint8_t x_first, x_last, y_first, y_last;
            [[nodiscard]] bool meet(const TilePart& r) const {
                // Without branches, because they would be mispredicted half of the time.
                return ((x_first < r.x_end) & (x_last >= r.x_begin) & (y_first < r.y_end) &
                        (y_last >= r.y_begin)) != 0;
            }
        };
        std::vector<std::uint32_t> patches;
        std::vector<Pixels> pixels;
        std::vector<PatchChain> chains;  ///< runs of `patches`, in ascending order of their paths
    };
    using Bins = std::vector<Bin>;  ///< per tile
    /// Lists, for each tile, the patches (parts of surfaces) that may appear in it, in the order of drawing.
    /// Directly visible patches come before those seen in mirrors. Among patches with the same sequence of
    /// reflections and transmissions, near ones come first.
    [[nodiscard]] Bins sorted(const PatchMesh& mesh, std::size_t instant, const MotionMarks& marks,
                              const PatchSweep& sweep) const;
    static void begin(const PatchMesh& mesh, TilePatches& out);
    /// Copies a patch to contiguous memory, which is faster to read: all patches of a tile are read for every
    /// lens point.
    void add(const PatchMesh& mesh, std::uint32_t patch, TilePatches& out) const;

    const PatchField& field_;
    int columns_, rows_;
    glm::dvec2 farthest_px_{0};     ///< for each axis, the largest |LensShift::lens_px|
    double farthest_shift_px_ = 0;  ///< largest shift of a point at infinity in a view, px
    bool trees_ = false;
    std::vector<Bins> primary_, deeper_;  ///< per instant
};

}  // namespace postlens
