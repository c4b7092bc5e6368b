// Groups the records of one instant into sheets, from which views are drawn. A sheet is one surface within a
// square of the raster. For each pixel it stores a quadtree of uniform colours and a plane of depths.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

/// Key of a surface. Nodes have the same key if they have the same object and the same path, and if the same
/// object reflects or transmits them.
struct SheetKey {
    NodePath path;  ///< empty for primary nodes
    std::uint32_t parent_id =
        0;  ///< id of the object that reflects or transmits this surface; 0 for primary nodes
    std::uint32_t id = 0;
    bool hidden = false;  ///< primary nodes recorded closely behind another surface
    friend bool operator==(const SheetKey&, const SheetKey&) = default;
    [[nodiscard]] bool operator<(const SheetKey& o) const {
        if (path != o.path) return path.bits() < o.path.bits();
        if (parent_id != o.parent_id) return parent_id < o.parent_id;
        return id != o.id ? id < o.id : hidden < o.hidden;
    }
};

/// A linear function of raster position: `value + x * dx + y * dy`. dx and dy are distances in px from the
/// function's origin, which is given where the function is stored.
struct CellPlane {
    float value = 0, x = 0, y = 0;
};

/// Colour and flags of a quadtree leaf.
struct Texel {
    float r = 0, g = 0, b = 0;  ///< scene-linear radiance of this node, without its children
    std::uint32_t info = 0;     ///< as `info_of` packs it
    /// Packs the sheet's index and flags into `info`. `unsure`: unsure_bit, unsure_below_bit, both, or 0.
    [[nodiscard]] static constexpr std::uint32_t info_of(std::uint32_t sheet, std::uint8_t children,
                                                         std::uint32_t unsure = 0) {
        return sheet << sheet_shift | unsure | children;
    }
    static constexpr std::uint32_t sheet_shift = 4, children_bits = 3, unsure_bit = 4, unsure_below_bit = 8;
    [[nodiscard]] std::uint32_t sheet() const { return info >> sheet_shift; }
    /// Bits (child_bit) for the presence of a reflected and of a transmitted child node.
    [[nodiscard]] std::uint8_t children() const { return static_cast<std::uint8_t>(info & children_bits); }
    /// Whether an edge may cross the quadtree leaf: the outline of the surface, a gap in it, or the edge of a
    /// shadow or texture. The colours at the leaf's corners then do not determine the colour of the leaf.
    [[nodiscard]] bool unsure() const { return (info & unsure_bit) != 0; }
    /// Whether the edge of a shadow or a texture crosses the quadtree leaf, in light that reaches its surface
    /// by reflection or transmission.
    [[nodiscard]] bool unsure_below() const { return (info & unsure_below_bit) != 0; }
    [[nodiscard]] std::uint32_t unsure_bits() const { return info & (unsure_bit | unsure_below_bit); }
};

/// A quadtree node is one of `none`, `maybe`, a leaf (index of its texel, plus the bit `leaf`), or the index
/// of its first child. The children follow each other: up-left, up-right, down-left, down-right. `maybe`
/// means that the surface's edge crosses the leaf and this corner shows a farther surface, so the surface may
/// or may not cover this quarter.
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

/// What nearer surfaces hide of a surface in a quadtree leaf.
enum class Hides : std::uint8_t {
    nothing,
    recorded,  ///< a part that is recorded as a hidden surface
    unknown    ///< a part that may not be recorded
};

/// Radiance above a limit that is removed from the sheets (recorded surfaces) and spread over the image by
/// its impulse response.
struct Highlight {
    float x = 0, y = 0;          ///< raster px
    std::array<float, 3> rgb{};  ///< radiance times px^2
    float area = 0;              ///< px^2 of the surface that emits it
    Mat2 w;                      ///< 1/m
    float inverse_z = 0;         ///< 1/m
    float bend = 0;              ///< Record::w_bend
    /// Gradient of 1/z' over the raster, 1/m per px, if rays have measured it; otherwise 0.
    glm::vec2 slope{0};
    std::uint32_t sheet = 0;
    Hides hides = Hides::nothing;

    /// Whether its radiance, above the limit for highlights, is at least `radiance` in any channel.
    [[nodiscard]] bool exceeds(float radiance) const {
        return std::max({rgb[0], rgb[1], rgb[2]}) >= radiance * area;
    }
};

/// A texel (colour of one quadtree leaf) whose radiance exceeds the limit for highlights.
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
    /// For each cell (raster pixel of a sheet), the root of its quadtree. `coarse` is used for surfaces that
    /// are blurred over several pixels; in it, a cell that the sheet fills is a single undivided leaf.
    std::vector<std::uint32_t> fine, coarse;
    /// For each cell, `values` linear functions with origin at the cell's centre, in 1/m. The first is 1/z'.
    /// Reflected and transmitted nodes also have the entries xx, xy, yx and yy of the matrix W.
    std::vector<CellPlane> planes;
    std::size_t values = 1;
    std::vector<float> bends;  ///< per cell, with W: its largest Record::w_bend
    std::vector<std::uint32_t> nodes;
    std::vector<Texel> texels;
    /// For each texel, the radiance of its reflected subtree and of its transmitted subtree
    /// (TreeSurface::below). Empty if there are no child nodes.
    std::vector<std::array<std::array<float, 3>, 2>> below;
    /// `bright` contains all radiance above the limit for highlights. `bright_texels` lists the texels of
    /// `fine` and `coarse` that have such radiance.
    std::vector<Highlight> bright;
    std::vector<BrightTexel> bright_texels;
    std::vector<Highlight> highlights;  ///< the elements of `bright` that are taken out of the texels

    [[nodiscard]] bool has_w() const { return values == 5; }
};

/// The sheets of one instant: those of surfaces seen directly, and those of surfaces seen by reflection or
/// transmission. A sheet is one surface within a square of the raster.
struct TreeSheets {
    SheetMesh primary;
    SheetMesh deeper;  ///< with W; empty without such nodes
};

/// The radiance of a sheet above the limit for highlights.
struct BrightSheet {
    float area_px2 = 0;
    Hides hides = Hides::nothing;  ///< what nearer surfaces hide in any of its leaves
};

/// Decides which radiance is spread as a highlight. If `takes` returns true, the highlight consists of the
/// radiance of each channel in excess of `above`.
struct HighlightRule {
    float above = 1;
    /// Returns whether `light` becomes a highlight. `key` and `sheet` describe its sheet. If empty,
    /// nothing is a highlight.
    std::function<bool(const Highlight& light, const SheetKey& key, const BrightSheet& sheet)> takes;
};
/// Sums up `bright` for each sheet of the mesh. Returns one element per sheet.
[[nodiscard]] std::vector<BrightSheet> bright_sheets(const SheetMesh& mesh);

/// Selects which sheets of an instant are built. A selected sheet is bit-identical to the one built without a
/// selection; only its index differs.
struct SheetChoice {
    /// Returns whether the row of squares that begins at raster row y is read. If empty, all rows are read.
    std::function<bool(int y)> rows;
    /// Removes the sheets that are not needed from `some`. `some` contains the sheets of `squares_per_part`
    /// neighbouring squares of the raster: part number `part` from the left, in the row of squares at raster
    /// row y. Several threads call it, before highlights are taken out. If empty, all sheets are needed.
    std::function<void(TreeSheets& some, int y, std::size_t part)> squares;
    bool deeper = true;  ///< whether reflected and transmitted nodes are needed
    /// Called for each row of squares that is not read, at raster row y. Appends those sheets of the row that
    /// are needed nevertheless, from left to right.
    std::function<void(std::vector<TreeSheets>& parts, int y)> known;
    static constexpr int squares_per_part = 8;
};

/// Reads the sheets of an instant from the file. Calls `also` for the rows that are read. Throws
/// Error(out_of_memory) if the sheets would not fit into memory, and passes on what the reader and `also`
/// throw.
[[nodiscard]] TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant,
                                     const HighlightRule& rule, const RecordsRead& also = {},
                                     const SheetChoice& choice = {});

/// Takes highlights out of existing sheets (recorded surfaces) by another rule with the same limit. The
/// result is bit-identical to that of `tree_sheets` called with this rule.
void take_highlights(TreeSheets& sheets, const HighlightRule& rule);

}  // namespace postlens
