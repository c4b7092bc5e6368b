// The records of one instant as sheets, from which views are drawn. A sheet is one surface within a square of
// the raster: per pixel a quadtree of uniform colours, and a plane of depths.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

/// Nodes of one key form a surface: same object, same path, same reflecting or transmitting object before it.
struct SheetKey {
    NodePath path;  ///< empty for primary nodes
    std::uint32_t parent_id =
        0;  ///< id of the object whose reflection or refraction shows it; 0 for primary nodes
    std::uint32_t id = 0;
    bool hidden = false;  ///< primary nodes recorded closely behind another surface
    friend bool operator==(const SheetKey&, const SheetKey&) = default;
    [[nodiscard]] bool operator<(const SheetKey& o) const {
        if (path != o.path) return path.bits() < o.path.bits();
        if (parent_id != o.parent_id) return parent_id < o.parent_id;
        return id != o.id ? id < o.id : hidden < o.hidden;
    }
};

/// A linear function of raster position: `value + x * dx + y * dy`, where dx and dy are px from the origin of
/// the pixel or patch that has the function.
struct CellPlane {
    float value = 0, x = 0, y = 0;
};

/// Colour and flags of a quadtree leaf.
struct Texel {
    float r = 0, g = 0, b = 0;  ///< scene-linear radiance of this node, without its children
    std::uint32_t info = 0;     ///< as `info_of` packs it
    /// Packs the sheet's number and flags into `info`. `unsure`: unsure_bit, unsure_below_bit, both, or 0.
    [[nodiscard]] static constexpr std::uint32_t info_of(std::uint32_t sheet, std::uint8_t children,
                                                         std::uint32_t unsure = 0) {
        return sheet << sheet_shift | unsure | children;
    }
    static constexpr std::uint32_t sheet_shift = 4, unsure_bit = 4, unsure_below_bit = 8;
    [[nodiscard]] std::uint32_t sheet() const { return info >> sheet_shift; }
    /// Bits (child_bit) of the bounces that have a child node there.
    [[nodiscard]] std::uint8_t children() const { return static_cast<std::uint8_t>(info & 3U); }
    /// Whether an edge of the surface, of a shadow or of a texture cuts the leaf, so that its corners do not
    /// determine its colour.
    [[nodiscard]] bool unsure() const { return (info & unsure_bit) != 0; }
    /// Whether such an edge cuts the leaf in the radiance of the reflected and transmitted child nodes.
    [[nodiscard]] bool unsure_below() const { return (info & unsure_below_bit) != 0; }
    [[nodiscard]] std::uint32_t unsure_bits() const { return info & (unsure_bit | unsure_below_bit); }
};

/// A quadtree node: `none`, `maybe`, a leaf (the number of its texel), or the index of its first child
/// (up-left, then up-right, down-left, down-right). `maybe`: the surface's edge cuts the leaf and this corner
/// shows a farther surface, so how far the surface reaches into this quarter is not known.
struct SheetNode {
    static constexpr std::uint32_t none = 0xFFFFFFFFU, maybe = 0xFFFFFFFEU, leaf = 0x80000000U;
    [[nodiscard]] static constexpr bool empty(std::uint32_t node) { return node >= maybe; }
};

/// One surface within a square of the raster.
struct Sheet {
    SheetKey key;
    int x = 0, y = 0;                            ///< raster px of its first cell; a cell is one pixel
    int width = 0, height = 0;                   ///< cells
    std::uint32_t first_cell = 0;                ///< index of its first cell; cells follow row by row
    int depth = 0;                               ///< levels of its deepest quadtree
    float inverse_z_min = 0, inverse_z_max = 0;  ///< 1/m
    std::array<float, 2> strays{};               ///< largest TreeSurface::strays of its nodes
};

/// Radiance above a limit that is taken out of the sheets and spread by its impulse response.
struct Highlight {
    float x = 0, y = 0;          ///< raster px
    std::array<float, 3> rgb{};  ///< radiance times px^2
    float area = 0;              ///< px^2 of the surface that emits it
    Mat2 w;                      ///< 1/m
    float inverse_z = 0;         ///< 1/m
    std::uint32_t sheet = 0;
    /// Whether a nearer surface cuts the leaf that the highlight was found in, and may hide more of it.
    bool cut_before = false;
};

/// A texel, the colour of one quadtree leaf, with radiance above the highlights' limit.
struct BrightTexel {
    std::uint32_t texel = 0;
    std::uint32_t first_light = 0, lights = 0;  ///< its elements of SheetMesh::bright
    float area = 1;                             ///< area of its leaf, px^2
    std::array<float, 3> rgb{};                 ///< its colour without these elements
};

struct SheetMesh {
    static constexpr int square_px = 16;  ///< edge of a sheet's square

    double time_s = 0;
    std::vector<Sheet> sheets;
    /// Per cell (raster pixel of a sheet), the root of its quadtree. `coarse` is for surfaces that are
    /// blurred over several pixels: there, a cell that the sheet fills is a single leaf.
    std::vector<std::uint32_t> fine, coarse;
    /// Per cell, `values` linear functions with origin at the cell's centre, 1/m: 1/z' and, for reflected and
    /// transmitted nodes, the entries xx, xy, yx, yy of the matrix W.
    std::vector<CellPlane> planes;
    std::size_t values = 1;
    std::vector<float> bends;  ///< per cell, with W: its largest Record::w_bend
    std::vector<std::uint32_t> nodes;
    std::vector<Texel> texels;
    /// Per texel, the radiance of its reflected and transmitted subtrees (TreeSurface::below). Empty if there
    /// are no child nodes.
    std::vector<std::array<std::array<float, 3>, 2>> below;
    /// All radiance above the highlights' limit, and the texels of `fine` and `coarse` that have such
    /// radiance.
    std::vector<Highlight> bright;
    std::vector<BrightTexel> bright_texels;
    std::vector<Highlight> highlights;  ///< the elements of `bright` that are taken out of the texels

    [[nodiscard]] bool has_w() const { return values == 5; }
};

/// Sheets (surfaces within squares of the raster) of the primary nodes, and of reflected and transmitted
/// nodes.
struct TreeSheets {
    SheetMesh primary;
    SheetMesh deeper;  ///< with W; empty without such nodes
};

/// Decides which radiance is spread as a highlight: per channel, the part above `above`, if `takes` returns
/// true.
struct HighlightRule {
    float above = 1;
    /// `key`: key of the highlight's sheet. `area_px2`: area of all radiance above the limit in that sheet.
    /// None: nothing is a highlight.
    std::function<bool(const Highlight& light, const SheetKey& key, float area_px2)> takes;
};
/// Per sheet, the area of its radiance above the limit, px^2.
[[nodiscard]] std::vector<float> bright_areas(const SheetMesh& mesh);

/// Selects which sheets of an instant are made. A selected sheet is bit-identical to the one made without a
/// selection, but its number differs.
struct SheetChoice {
    /// Whether the row of squares that begins at raster row y is read; none: all rows are.
    std::function<bool(int y)> rows;
    /// Removes the sheets that are not needed from `some`, which holds the sheets of `squares_per_part`
    /// neighbouring squares of the raster: part number `part` from the left, in the row of squares at raster
    /// row y. Called from several threads, before highlights are taken out. None: all sheets are needed.
    std::function<void(TreeSheets& some, int y, std::size_t part)> squares;
    bool deeper = true;  ///< whether reflected and transmitted nodes are needed
    /// Called for each row of squares that is not read, at raster row y. Appends the sheets of this row that
    /// are needed nevertheless, from left to right.
    std::function<void(std::vector<TreeSheets>& parts, int y)> known;
    static constexpr int squares_per_part = 8;
};

/// Reads the sheets of an instant from the file. `also` is called for the rows that are read. Throws
/// Error(out_of_memory) before it exceeds the memory, and what the reader and `also` throw.
[[nodiscard]] TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant,
                                     const HighlightRule& rule, const RecordsRead& also = {},
                                     const SheetChoice& choice = {});

/// Takes highlights out of existing sheets by another rule with the same limit. The result is bit-identical
/// to that of `tree_sheets` with this rule.
void take_highlights(TreeSheets& sheets, const HighlightRule& rule);

}  // namespace postlens
