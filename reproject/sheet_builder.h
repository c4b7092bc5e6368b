// Leaves of the quadtree, one square of the raster at a time, made into sheets.
#pragma once

#include <span>
#include <vector>

#include "records/quadtree.h"
#include "reproject/sample_surfaces.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

/// Pixels of a square: rows of the leaves' band from its first, columns [first_pixel, last_pixel) of it.
struct SheetSquare {
    int first_pixel = 0, last_pixel = 0, rows = 0;
    int band_width = 0;
    int x = 0, y = 0;  ///< raster px
};

/// The four corners of a leaf that see one surface give a square with their mean; where a corner sees another
/// or the depth jumps, each corner has the quarter of the leaf next to it. Within a cell, parts of a key that
/// cannot be one surface go to sheets of their own.
class SheetBuilder {
  public:
    /// Keeps references to all.
    SheetBuilder(const PixelLeaves& leaves, const SampleTrees& trees, const SampleHeader& header,
                 const HighlightRule& rule, SheetMesh& out);
    void build(const SheetSquare& square);

  private:
    /// A square of the raster that shows one surface: its corners' nodes, or one node for a quarter.
    struct Piece {
        SheetKey key;
        int cell = 0;
        float x = 0, y = 0, size = 0;  ///< px from the cell's corner
        std::array<std::uint32_t, 4> node{};
        int corners = 4;  ///< 1: node[0] alone, which stands at (at_x, at_y)
        float at_x = 0, at_y = 0;
    };
    void add_leaf(const Leaf& leaf, int cell, const SheetSquare& square);
    void add_group(const SheetKey& key, const std::array<std::uint32_t, 4>& corners, float x, float y,
                   float size, int cell);
    void add_sheets(std::size_t begin, std::size_t end, const SheetSquare& square);
    void add_cell(std::size_t sheet, std::span<const Piece* const> pieces, int cell);
    std::uint32_t add_tree(std::size_t sheet, std::vector<const Piece*>& pieces, std::size_t begin,
                           std::size_t end, float x, float y, float size, int depth);
    std::uint32_t add_texel(std::size_t sheet, const Piece& piece);
    void fit(std::span<const Piece* const> pieces, Plane* planes) const;
    /// Notes that a texel of this area has the light that was added since there was so much.
    void note_bright(std::size_t first_light, float area);
    void emit(const SheetSquare& square);
    [[nodiscard]] bool continuous(float low, float high, float size) const;
    [[nodiscard]] const TreeSurface& node(std::uint32_t i) const { return trees_.nodes[i]; }

    /// A sheet as it is being made, over the whole square.
    struct Draft {
        SheetKey key;
        std::vector<std::uint32_t> fine, coarse;
        std::vector<Plane> planes;
        int depth = 0;
        std::uint32_t number = 0;
    };

    const PixelLeaves& leaves_;
    const SampleTrees& trees_;
    const HighlightRule& rule_;
    SheetMesh& out_;
    double per_px_;
    bool perspective_;
    SheetSquare square_;
    std::vector<Piece> pieces_;
    std::vector<Draft> drafts_;
    std::size_t drafts_used_ = 0;
    std::vector<const Piece*> tree_pieces_;
    /// Of the texels of a cell, by area.
    struct Mean {
        std::array<double, 3> rgb{};
        std::array<std::array<double, 3>, 2> below{};
        std::uint8_t children = 0;
        double area = 0;
        std::size_t texels = 0;
    } mean_;
};

}  // namespace postlens
