// The records of one instant as sheets: surfaces cut into squares of the raster, whose colour is a quadtree
// of even squares for each pixel and whose depth is a plane for each pixel. What many views are drawn from.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

/// What belongs together: an id, and where it is seen in mirrors or glass, in which.
struct SheetKey {
    NodePath path;                ///< of a primary node: none
    std::uint32_t parent_id = 0;  ///< of the mirror or glass that it is seen in; 0 for primary nodes
    std::uint32_t id = 0;
    bool hidden = false;  ///< of primary nodes: something is closely in front of it where it was recorded
    friend bool operator==(const SheetKey&, const SheetKey&) = default;
    [[nodiscard]] bool operator<(const SheetKey& o) const {
        if (path != o.path) return path.bits() < o.path.bits();
        if (parent_id != o.parent_id) return parent_id < o.parent_id;
        return id != o.id ? id < o.id : hidden < o.hidden;
    }
};

/// A function of the place: `value + x * dx + y * dy`, x and y in px from where its owner says.
struct CellPlane {
    float value = 0, x = 0, y = 0;
};

/// The colour of a square, with what else is known of it.
struct Texel {
    float r = 0, g = 0, b = 0;  ///< scene-linear, of this node of the shading tree alone
    std::uint32_t info = 0;     ///< as `info_of` packs it
    /// `unsure`: some of unsure_bit and unsure_below_bit.
    [[nodiscard]] static constexpr std::uint32_t info_of(std::uint32_t sheet, std::uint8_t children,
                                                         std::uint32_t unsure = 0) {
        return sheet << sheet_shift | unsure | children;
    }
    static constexpr std::uint32_t sheet_shift = 4, unsure_bit = 4, unsure_below_bit = 8;
    [[nodiscard]] std::uint32_t sheet() const { return info >> sheet_shift; }
    /// child_bit of the bounces that have a node there.
    [[nodiscard]] std::uint8_t children() const { return static_cast<std::uint8_t>(info & 3U); }
    /// Whether an edge cuts the leaf it was made of: of the surface, a shadow or a texture. What lies between
    /// the leaf's corners is then not known.
    [[nodiscard]] bool unsure() const { return (info & unsure_bit) != 0; }
    /// The same of the light of all that is seen in it.
    [[nodiscard]] bool unsure_below() const { return (info & unsure_below_bit) != 0; }
    [[nodiscard]] std::uint32_t unsure_bits() const { return info & (unsure_bit | unsure_below_bit); }
};

/// A node of a pixel's quadtree: `none`, `maybe`, a leaf with its texel, or the first of four nodes (up-left,
/// up-right, down-left, down-right). `maybe`: the surface's edge cuts the leaf, and this corner of it shows
/// something farther away; how far the surface reaches into its quarter is not known.
struct SheetNode {
    static constexpr std::uint32_t none = 0xFFFFFFFFU, maybe = 0xFFFFFFFEU, leaf = 0x80000000U;
    [[nodiscard]] static constexpr bool empty(std::uint32_t node) { return node >= maybe; }
};

/// One surface within one square of the raster.
struct Sheet {
    SheetKey key;
    int x = 0, y = 0;                            ///< raster px of its first cell; a cell is a pixel
    int width = 0, height = 0;                   ///< cells
    std::uint32_t first_cell = 0;                ///< row by row
    int depth = 0;                               ///< levels of its deepest quadtree
    float inverse_z_min = 0, inverse_z_max = 0;  ///< 1/m
    std::array<float, 2> strays{};               ///< the greatest TreeSurface::strays of its texels
};

/// Light above a limit, taken from the sheets to be spread by its exact response.
struct Highlight {
    float x = 0, y = 0;          ///< raster px
    std::array<float, 3> rgb{};  ///< radiance times px^2
    float area = 0;              ///< px^2
    Mat2 w;                      ///< 1/m
    float inverse_z = 0;         ///< 1/m
    std::uint32_t sheet = 0;
    bool cut_before =
        false;  ///< something nearer cuts the leaf it was found in: there may be more of it behind that
};

/// A texel that has light above the limit.
struct BrightTexel {
    std::uint32_t texel = 0;
    std::uint32_t first_light = 0, lights = 0;  ///< of SheetMesh::bright: what it has of that
    float area = 1;                             ///< px^2 of its square
    std::array<float, 3> rgb{};                 ///< its colour without that
};

struct SheetMesh {
    static constexpr int square_px = 16;  ///< edge of a sheet's square

    double time_s = 0;
    std::vector<Sheet> sheets;
    /// By cell: the root of its quadtree; and, for where it comes to a blur of several pixels, the same with
    /// cells that the sheet fills as a single square.
    std::vector<std::uint32_t> fine, coarse;
    /// By cell, `values` each, around the cell's middle: 1/z', then with W its xx, xy, yx, yy; 1/m.
    std::vector<CellPlane> planes;
    std::size_t values = 1;
    std::vector<float> bends;  ///< by cell, with W: the greatest Record::w_bend that it has
    std::vector<std::uint32_t> nodes;
    std::vector<Texel> texels;
    /// By texel where something is seen in mirrors or glass here, else empty: TreeSurface's.
    std::vector<std::array<std::array<float, 3>, 2>> below;
    /// All light above the limit, and the texels that have it, fine and coarse, unless it is taken.
    std::vector<Highlight> bright;
    std::vector<BrightTexel> bright_texels;
    std::vector<Highlight> highlights;  ///< what of it is taken

    [[nodiscard]] bool has_w() const { return values == 5; }
};

/// The shading trees taken apart: what is seen directly, and what is seen in mirrors and through glass.
struct TreeSheets {
    SheetMesh primary;
    SheetMesh deeper;  ///< with W; no sheets where there are no deeper nodes
};

/// What of a colour is a highlight: all above `above` in any channel, of what `takes` says.
struct HighlightRule {
    float above = 1;
    /// None: nothing is. `key`: of the sheet that it is in. `area_px2`: of all light above the limit there.
    std::function<bool(const Highlight& light, const SheetKey& key, float area_px2)> takes;
};
/// By sheet, px^2: of all light above the limit.
[[nodiscard]] std::vector<float> bright_areas(const SheetMesh& mesh);

/// Which of an instant's sheets are wanted. Those that are have the same bits as among all, but other
/// numbers.
struct SheetChoice {
    /// Whether the squares from row y of the raster on are to be looked at; none: all are.
    std::function<bool(int y)> rows;
    /// Takes from `squares_per_part` neighbouring squares, those from row y on and the `part`th of them from
    /// the left, the sheets that are not wanted; highlights are not taken yet. From several threads. None:
    /// all are wanted.
    std::function<void(TreeSheets& some, int y, std::size_t part)> squares;
    bool deeper = true;  ///< whether what is seen in mirrors and through glass is wanted
    /// Of rows that are not looked at: appends what is wanted of them nevertheless, from the left.
    std::function<void(std::vector<TreeSheets>& parts, int y)> known;
    static constexpr int squares_per_part = 8;
};

/// Reads an instant of the file. Throws Error(out_of_memory) before it would take more than there is, and
/// what the reader and `also` throw. `also` is told of rows that are looked at.
[[nodiscard]] TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant,
                                     const HighlightRule& rule, const RecordsRead& also = {},
                                     const SheetChoice& choice = {});

/// Makes of sheets those of another rule with the same limit: bit for bit what `tree_sheets` gives for it.
void take_highlights(TreeSheets& sheets, const HighlightRule& rule);

}  // namespace postlens
