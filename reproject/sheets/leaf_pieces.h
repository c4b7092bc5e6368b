// Divides the quadtree cells in a raster square into pieces that each show one surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "records/quadtree.h"
#include "reproject/sheets/sample_surfaces.h"
#include "reproject/sheets/sheet_keys.h"

namespace postlens {

/// A square of pixels in a band of raster rows: columns [first_pixel, last_pixel), and the first `rows` rows.
struct SheetSquare {
    int first_pixel = 0, last_pixel = 0, rows = 0;
    int band_width = 0;
    int x = 0, y = 0;  ///< raster px
};

/// A quadtree cell, or the quarter of one, that shows a single surface.
struct LeafPiece {
    std::uint32_t key = 0;   ///< index into SheetKeys::keys
    std::uint32_t leaf = 0;  ///< index into PixelLeaves::leaves
    int cell = 0;
    float x = 0, y = 0, size = 0;  ///< px from the cell's corner
    std::array<std::uint32_t, 4> node{};
    /// Number of used elements of node[]: 4 if each corner of the quadtree cell has a ray hit, or 1 for a
    /// single hit, (at_x, at_y) px from the pixel's corner.
    int corners = 4;
    float at_x = 0, at_y = 0;
    Hides hides = Hides::nothing;  ///< by nearer surfaces
    /// True if the surface may be absent from this quarter of the quadtree cell, because an edge crosses the
    /// cell.
    bool maybe = false;
};

/// Divides the cells of quadtrees into pieces. If the rays through a cell's four corners hit one continuous
/// surface, the cell is one piece. Otherwise each quarter is a piece that shows the surface at its corner.
class LeafPieces {
  public:
    /// Keeps references to all arguments but `header`.
    LeafPieces(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
               const SampleHeader& header);
    /// Replaces the pieces by the pieces of a square.
    void collect(const SheetSquare& square);
    /// Calls take(key, pieces) for each surface, in ascending order of keys. `pieces` are the parts of
    /// quadtree cells that show the surface. Call once after each `collect`.
    template <typename Take>
    void each_surface(const Take& take) {
        std::uint32_t begin = 0;
        for (const std::uint32_t key : keys_used_) {
            const std::uint32_t end = key_pieces_[key];
            take(key, std::span<const LeafPiece* const>(sorted_).subspan(begin, end - begin));
            key_pieces_[key] = 0;
            begin = end;
        }
    }
    /// True if inverse depths from `low` to `high`, in 1/m, may belong to one continuous surface within
    /// `size` px.
    [[nodiscard]] bool continuous(float low, float high, float size) const {
        return is_one_surface(low, high, static_cast<double>(size) * per_px_, perspective_);
    }

  private:
    /// Ray hits of one surface at the corners of a quadtree cell. If a ray hits the surface several times,
    /// group n has the n-th nearest hits.
    struct Group {
        std::uint32_t key = 0;
        std::uint32_t next = 0;  ///< index of the group of the (n + 1)-th nodes
        std::array<std::uint32_t, 4> corners{};
    };
    /// `index` is an index into PixelLeaves::leaves.
    void add_leaf(std::uint32_t index, int cell);
    void add_group(std::uint32_t key, const std::array<std::uint32_t, 4>& corners, float x, float y, int cell,
                   std::uint32_t index);
    /// Whether a corner of a quadtree cell shows a given surface (`here`), a nearer one (`before`) or a
    /// farther one (`behind`).
    struct Beside {
        bool before = false, behind = false, here = false;
    };
    [[nodiscard]] Beside beside(std::uint32_t corner, const TreeSurface& of, float size) const;
    void add_piece(const LeafPiece& piece);
    void sort_pieces();
    [[nodiscard]] const TreeSurface& node(std::uint32_t i) const { return trees_.nodes[i]; }

    const PixelLeaves& leaves_;
    const SampleTrees& trees_;
    const SheetKeys& keys_;
    double per_px_;
    bool perspective_;
    SheetSquare square_;
    std::vector<LeafPiece> pieces_;
    std::vector<const LeafPiece*> sorted_;  ///< pieces_ by key, stable
    std::vector<std::uint32_t> keys_used_;  ///< keys of pieces_, ascending once sorted
    /// key_pieces_: number of pieces (parts of quadtree cells) of each surface; after sort_pieces, their end
    /// in sorted_.
    /// key_group_: first group of ray hits of each surface at the current cell.
    std::vector<std::uint32_t> key_pieces_, key_group_;
    std::vector<Group> groups_;
};

}  // namespace postlens
