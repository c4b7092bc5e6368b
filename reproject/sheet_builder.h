// Leaves of the quadtree, one square of the raster at a time, made into sheets.
#pragma once

#include <span>
#include <vector>

#include "records/quadtree.h"
#include "reproject/sample_surfaces.h"
#include "reproject/sheet_keys.h"
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
    SheetBuilder(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
                 const SampleHeader& header, const HighlightRule& rule, SheetMesh& out);
    void build(const SheetSquare& square);

  private:
    /// A square of the raster that shows one surface: its corners' nodes, or one node for a quarter.
    struct Piece {
        std::uint32_t key = 0;  ///< of keys_
        int cell = 0;
        float x = 0, y = 0, size = 0;  ///< px from the cell's corner
        std::array<std::uint32_t, 4> node{};
        int corners = 4;  ///< 1: node[0] alone, which stands at (at_x, at_y)
        float at_x = 0, at_y = 0;
        bool cut_before = false;  ///< Highlight's
        bool maybe = false;       ///< SheetNode::maybe: the surface of node[0] may reach as far as here
    };
    /// What the corners of a leaf have in common: the n-th node of a key at each.
    struct Group {
        std::uint32_t key = 0;
        std::uint32_t next = 0;  ///< the group of the (n + 1)-th
        std::array<std::uint32_t, 4> corners{};
    };
    void add_leaf(const Leaf& leaf, int cell);
    void add_group(std::uint32_t key, const std::array<std::uint32_t, 4>& corners, float x, float y,
                   float size, int cell, const Leaf& leaf);
    /// What a corner of a leaf shows beside a surface: something before it, and, where it does not show the
    /// surface itself, something behind it.
    struct Beside {
        bool before = false, behind = false;
    };
    [[nodiscard]] Beside beside(std::uint32_t corner, const TreeSurface& of, float size) const;
    /// Whether an edge of a shadow or a texture lies between a piece's corners.
    [[nodiscard]] bool has_contrast(const Piece& piece) const;
    /// Whether all its corners are marked: what lies between them is not known.
    [[nodiscard]] bool is_marked(const Piece& piece) const;
    [[nodiscard]] bool has_contrast_below(const Piece& piece) const;
    [[nodiscard]] bool is_contrast(float a, float b, float c, float d) const;
    void add_piece(const Piece& piece);
    void sort_pieces();
    void add_sheets(std::span<const Piece* const> pieces);
    void add_cell(std::size_t sheet, std::span<const Piece* const> pieces, int cell);
    std::uint32_t add_tree(std::size_t sheet, std::vector<const Piece*>& pieces, std::size_t begin,
                           std::size_t end, float x, float y, float size, int depth);
    std::uint32_t add_texel(std::size_t sheet, const Piece& piece);
    template <std::size_t values>
    void fit(std::span<const Piece* const> pieces, CellPlane* planes) const;
    /// Notes that a texel of this area has the light that was added since there was so much.
    void note_bright(std::size_t first_light, float area);
    void emit();
    [[nodiscard]] bool continuous(float low, float high, float size) const;
    [[nodiscard]] const TreeSurface& node(std::uint32_t i) const { return trees_.nodes[i]; }

    /// A sheet as it is being made: its cells in the square's order, with what is in each.
    struct Draft {
        std::vector<int> cells;
        std::vector<std::uint32_t> fine, coarse;
        std::vector<CellPlane> planes;
        std::vector<float> bends;
        int depth = 0;
        std::array<float, 2> strays{};
        std::uint32_t number = 0;
    };

    const PixelLeaves& leaves_;
    const SampleTrees& trees_;
    const SheetKeys& keys_;
    const HighlightRule& rule_;
    SheetMesh& out_;
    double per_px_;
    float contrast_, black_;
    bool perspective_;
    SheetSquare square_;
    std::vector<Piece> pieces_;
    std::vector<const Piece*> sorted_;      ///< by key, in each as they came
    std::vector<std::uint32_t> keys_used_;  ///< by pieces_; growing once sorted
    /// By key: pieces, then where in sorted_ they end; and the first group of a leaf. 0 and `none` between
    /// uses.
    std::vector<std::uint32_t> key_pieces_, key_group_;
    std::vector<Group> groups_;
    std::vector<Draft> drafts_;
    std::size_t drafts_used_ = 0;
    SheetKey key_;  ///< of the drafts
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
