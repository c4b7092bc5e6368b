// Divides the quadtree cells of the pixels in a raster square into pieces that each show one surface.
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

/// A square of the raster, at most 16 x 16 px. The raster is read in strips, which are `band_width` px wide
/// and `rows` px high. The square has the same height as its strip, and covers the strip's columns
/// [first_pixel, last_pixel).
struct SheetSquare {
    int first_pixel = 0, last_pixel = 0, rows = 0;
    int band_width = 0;
    int x = 0, y = 0;  ///< raster px
};

/// A part of a raster pixel that shows one surface. It is a whole quadtree cell if the rays through the
/// cell's four corners hit the same surface. Otherwise, it is a quarter of the cell.
struct LeafPiece {
    std::uint32_t key = 0;   ///< index into SheetKeys::keys
    std::uint32_t leaf = 0;  ///< index into PixelLeaves::leaves
    int cell = 0;
    float x = 0, y = 0, size = 0;  ///< px from the cell's corner
    std::array<std::uint32_t, 4> node{};
    /// Number of recorded ray hits on which this part of a pixel is based: 4 for a whole quadtree cell, and 1
    /// for a quarter of a cell. In the latter case, the ray passes through (at_x, at_y), in px from the
    /// pixel's corner.
    int corners = 4;
    float at_x = 0, at_y = 0;
    Hides hides = Hides::nothing;  ///< by nearer surfaces
    /// True if this piece is a quarter of a quadtree cell, and an edge of the surface crosses the cell. The
    /// exact course of the edge is unknown, so the surface may be absent from a part of the piece or from the
    /// whole piece.
    bool maybe = false;
};

/// Divides quadtree cells into pieces that each show one surface. If the rays through a cell's four corners
/// hit one continuous surface, the cell is one piece. Otherwise its quarters are pieces: each shows the
/// surface that was hit at the cell's corner in this quarter.
class LeafPieces {
  public:
    /// Keeps references to all arguments but `header`.
    LeafPieces(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
               const SampleHeader& header);
    /// Replaces the pieces by the pieces of a square.
    void collect(const SheetSquare& square);
    /// Calls take(key, pieces) once for each surface in the square of the raster that was passed to
    /// `collect`. `key` is the index of the surface in SheetKeys::keys; the calls are in ascending order of
    /// it. `pieces` are the quadtree cells, or quarters of cells, that show it. Call this function only once
    /// after each `collect`.
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
    /// Returns whether two points may belong to one continuous surface. Their inverse depths are `low` and
    /// `high`, in 1/m; their distance in the image is `size`, in px.
    [[nodiscard]] bool continuous(float low, float high, float size) const {
        return is_one_surface(low, high, static_cast<double>(size) * per_px_, perspective_);
    }

  private:
    /// The hits of four rays on one surface. The rays pass through the corners of a quadtree cell. A ray may
    /// hit the same surface several times. In this case, the first group contains the nearest hit of each
    /// ray, the second group the second nearest, and so on.
    struct Group {
        std::uint32_t key = 0;
        std::uint32_t next = 0;  ///< index of the group of the (n + 1)-th nodes
        std::array<std::uint32_t, 4> corners{};
    };
    /// `index` is an index into PixelLeaves::leaves.
    void add_leaf(std::uint32_t index, int cell);
    void add_group(std::uint32_t key, const std::array<std::uint32_t, 4>& corners, float x, float y, int cell,
                   std::uint32_t index);
    /// What the ray through a corner of a quadtree cell hits, compared with a given surface: this surface
    /// itself (`here`), a nearer surface (`before`) or a farther one (`behind`).
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
    /// For each surface: `key_pieces_` counts its pieces, i.e. the quadtree cells (or quarters of cells) that
    /// show it. Later, it tells where the surface's pieces end in `sorted_`. `key_group_` is the index of the
    /// surface's first element in `groups_`.
    std::vector<std::uint32_t> key_pieces_, key_group_;
    std::vector<Group> groups_;
};

}  // namespace postlens
