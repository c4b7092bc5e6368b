// Builds the sheets of one square of the raster, one per surface seen there, from the quadtree leaves.
#pragma once

#include <span>
#include <vector>

#include "records/quadtree.h"
#include "reproject/sheets/sample_surfaces.h"
#include "reproject/sheets/sheet_keys.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// The pixels of a square of the raster: the first `rows` rows of the leaves' band, columns [first_pixel,
/// last_pixel).
struct SheetSquare {
    int first_pixel = 0, last_pixel = 0, rows = 0;
    int band_width = 0;
    int x = 0, y = 0;  ///< raster px
};

/// Builds sheets from the samples at the corners of quadtree leaves. If all four corners of a leaf see one
/// surface, the leaf gets their mean. If a corner sees another surface, or the depth jumps, each corner gets
/// the adjacent quarter of the leaf. Parts of one object whose depths differ too much for one surface become
/// different sheets.
class SheetBuilder {
  public:
    /// Keeps references to all arguments.
    SheetBuilder(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
                 const SampleHeader& header, const HighlightRule& rule, SheetMesh& out);
    void build(const SheetSquare& square);

  private:
    /// A leaf that shows one surface, or a quarter of a leaf.
    struct Piece {
        std::uint32_t key = 0;  ///< index into keys_
        int cell = 0;
        float x = 0, y = 0, size = 0;  ///< px from the cell's corner
        std::array<std::uint32_t, 4> node{};
        int corners =
            4;  ///< 4: the leaf's corners; 1: a quarter, only node[0], at (at_x, at_y) px in the cell
        float at_x = 0, at_y = 0;
        bool cut_before = false;  ///< Highlight::cut_before
        bool maybe = false;       ///< SheetNode::maybe: the surface of node[0] may extend into this quarter
    };
    /// The n-th node, counted from the nearest, that a surface (SheetKey) has at each corner of a leaf.
    struct Group {
        std::uint32_t key = 0;
        std::uint32_t next = 0;  ///< index of the group of the (n + 1)-th nodes
        std::array<std::uint32_t, 4> corners{};
    };
    void add_leaf(const Leaf& leaf, int cell);
    void add_group(std::uint32_t key, const std::array<std::uint32_t, 4>& corners, float x, float y,
                   float size, int cell, const Leaf& leaf);
    /// Which other surfaces the corners of a leaf show beside a given one. `before`: a corner shows a nearer
    /// one. `behind`: a corner shows a farther one, and not the given one.
    struct Beside {
        bool before = false, behind = false;
    };
    [[nodiscard]] Beside beside(std::uint32_t corner, const TreeSurface& of, float size) const;
    /// Whether the colours at the leaf's corners differ so much that an edge of a shadow or a texture crosses
    /// it.
    [[nodiscard]] bool has_contrast(const Piece& piece) const;
    /// Whether the records at all corners have a mark, for example for fine texture (RecordMark).
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
    /// Assigns the highlights from index `first_light` on to the texel that was added last; `area`: its area,
    /// px^2.
    void note_bright(std::size_t first_light, float area);
    void emit();
    [[nodiscard]] bool continuous(float low, float high, float size) const;
    [[nodiscard]] const TreeSurface& node(std::uint32_t i) const { return trees_.nodes[i]; }

    /// A sheet under construction. Its pixels are in the order of the square's pixels.
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
    std::vector<const Piece*> sorted_;      ///< pieces_ by key, stable
    std::vector<std::uint32_t> keys_used_;  ///< keys of pieces_, ascending once sorted
    /// Per key, that is per surface: the number of its pieces, later their end in sorted_; and its first
    /// Group at the current leaf. Reset to 0 and `none` after use.
    std::vector<std::uint32_t> key_pieces_, key_group_;
    std::vector<Group> groups_;
    std::vector<Draft> drafts_;
    std::size_t drafts_used_ = 0;
    SheetKey key_;  ///< key of the drafts
    std::vector<const Piece*> tree_pieces_;
    /// Mean of the texels within a pixel, weighted by area.
    struct Mean {
        std::array<double, 3> rgb{};
        std::array<std::array<double, 3>, 2> below{};
        std::uint8_t children = 0;
        double area = 0;
        std::size_t texels = 0;
    } mean_;
};

}  // namespace postlens
