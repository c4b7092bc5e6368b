// Builds sheets (parts of surfaces) from recorded ray hits. The hits lie at the corners of quadtree cells,
// into which the pixels are divided. A sheet is the part of one surface within a square of 16 x 16 px.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reproject/sheets/leaf_pieces.h"
#include "reproject/sheets/sample_surfaces.h"
#include "reproject/sheets/sheet_keys.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Builds sheets from the recorded hits of eye rays. A sheet is the part of one surface within a square of 16
/// x 16 px of the recorded image. If parts of a surface in the square have very different depths, they become
/// different sheets.
class SheetBuilder {
  public:
    /// Keeps references to all arguments.
    SheetBuilder(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
                 const SampleHeader& header, const HighlightRule& rule, SheetMesh& out);
    void build(const SheetSquare& square);

  private:
    /// True if the colours at the corners of the quadtree cell differ so much that the edge of a shadow or
    /// texture must cross it.
    [[nodiscard]] bool has_contrast(const LeafPiece& piece) const;
    /// A piece is a quadtree cell that shows one surface. Returns the flags (RecordMark) that are set for the
    /// ray hits at all four corners of the piece. For example, one flag means that the surface's texture is
    /// finer than the samples.
    [[nodiscard]] std::uint8_t marks(const LeafPiece& piece) const;
    [[nodiscard]] bool is_unsure_below(const LeafPiece& piece) const;
    [[nodiscard]] bool is_contrast(float a, float b, float c, float d) const;
    void add_sheets(std::span<const LeafPiece* const> pieces);
    void add_cell(std::size_t sheet, std::span<const LeafPiece* const> pieces, int cell);
    std::uint32_t add_tree(std::size_t sheet, std::vector<const LeafPiece*>& pieces, std::size_t begin,
                           std::size_t end, float x, float y, float size, int depth);
    std::uint32_t add_texel(std::size_t sheet, const LeafPiece& piece);
    template <std::size_t values>
    void fit(std::span<const LeafPiece* const> pieces, CellPlane* planes) const;
    /// Adds an entry to the list of bright texels if the texel added last (the colour of a quadtree cell) has
    /// highlights, i.e. radiance above a limit. The caller has appended these to `bright`, from the index
    /// `first_light` on. `area` is the area of the cell, in px^2.
    void note_bright(std::size_t first_light, float area);
    void emit();
    [[nodiscard]] const TreeSurface& node(std::uint32_t i) const { return trees_.nodes[i]; }

    /// Data of a sheet (part of a surface in a square of 16 x 16 px) that is being built. `cells` lists the
    /// pixels that show the sheet, as indices y * 16 + x in ascending order. The other lists hold values for
    /// these pixels, as in SheetMesh.
    struct Draft {
        std::vector<int> cells;
        std::vector<std::uint32_t> fine, coarse;
        std::vector<CellPlane> planes;
        std::vector<float> bends;
        int depth = 0;
        std::array<float, 2> strays{};
        std::uint32_t number = 0;
    };

    const SampleTrees& trees_;
    const SheetKeys& keys_;
    const HighlightRule& rule_;
    SheetMesh& out_;
    float contrast_, black_;
    SheetSquare square_;
    LeafPieces pieces_;
    std::vector<Draft> drafts_;
    std::size_t drafts_used_ = 0;
    SheetKey key_;  ///< key of the drafts
    std::vector<const LeafPiece*> tree_pieces_;
    /// Mean of the texels within a pixel, weighted by area.
    struct Mean {
        std::array<double, 3> rgb{};
        std::array<std::array<double, 3>, 2> below{};
        std::uint8_t children = 0;
        bool may_have_gap = false;  ///< RecordMark::gap
        double area = 0;
        std::size_t texels = 0;
    } mean_;
};

}  // namespace postlens
