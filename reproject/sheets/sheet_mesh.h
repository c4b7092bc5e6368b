// Groups the records of one instant into sheets, from which views are drawn. A sheet is one surface within a
// square of the raster. Each of its pixels has a quadtree of uniform colours and a plane of depths.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

/// Identifies a surface. Nodes belong to one surface if four facts agree: their object, their path (sequence
/// of reflections and transmissions), the object that reflects or transmits them, and whether they lie
/// closely behind another surface.
struct SheetKey {
    NodePath path;  ///< empty for primary nodes
    std::uint32_t parent_id =
        0;  ///< id of the object that reflects or transmits this surface; 0 for primary nodes
    std::uint32_t id = 0;
    bool hidden = false;  ///< for primary nodes: recorded closely behind another surface
    friend bool operator==(const SheetKey&, const SheetKey&) = default;
    [[nodiscard]] bool operator<(const SheetKey& o) const {
        if (path != o.path) return path.bits() < o.path.bits();
        if (parent_id != o.parent_id) return parent_id < o.parent_id;
        return id != o.id ? id < o.id : hidden < o.hidden;
    }
};

/// A linear function of raster position: `value + x * dx + y * dy`. (dx, dy) is the offset from the
/// function's origin, in px; x and y are slopes. Each list of such functions states its origin.
struct CellPlane {
    float value = 0, x = 0, y = 0;
};

/// Colour and flags of a quadtree leaf.
struct Texel {
    float r = 0, g = 0, b = 0;  ///< scene-linear radiance of this node, without its children
    std::uint32_t info = 0;     ///< as `info_of` packs it
    /// Packs the index of a texel's sheet, the bits of the texel's children (child_bit) and two flags into
    /// one word. `unsure` is unsure_bit, unsure_below_bit, both, or 0.
    [[nodiscard]] static constexpr std::uint32_t info_of(std::uint32_t sheet, std::uint8_t children,
                                                         std::uint32_t unsure = 0) {
        return sheet << sheet_shift | unsure | children;
    }
    static constexpr std::uint32_t sheet_shift = 4, children_bits = 3, unsure_bit = 4, unsure_below_bit = 8;
    [[nodiscard]] std::uint32_t sheet() const { return info >> sheet_shift; }
    /// Returns two bits (child_bit), which state whether a reflection and a refraction of the surface are
    /// recorded.
    [[nodiscard]] std::uint8_t children() const { return static_cast<std::uint8_t>(info & children_bits); }
    /// Returns whether an edge may cross the quadtree leaf, so that the colours at the leaf's corners do not
    /// determine its colour. The edge may be the outline of the surface, a gap in the surface, or the edge of
    /// a shadow or texture.
    [[nodiscard]] bool unsure() const { return (info & unsure_bit) != 0; }
    /// Returns whether light that the surface reflects or transmits contains the edge of a shadow or texture
    /// within the quadtree leaf.
    [[nodiscard]] bool unsure_below() const { return (info & unsure_below_bit) != 0; }
    [[nodiscard]] std::uint32_t unsure_bits() const { return info & (unsure_bit | unsure_below_bit); }
};

/// A node of a sheet's quadtree is one of:
/// - `none`: empty;
/// - `maybe`: a quarter of a leaf that the surface's edge crosses. The leaf's corner in this quarter shows a
///   farther surface, but the rest of the quarter may show this surface;
/// - a leaf: the index of its texel (colour) with the bit `leaf` set;
/// - otherwise the index of its first child. The children are consecutive: up-left, up-right, down-left,
///   down-right.
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
    int depth = 0;                               ///< number of levels of its deepest quadtree
    float inverse_z_min = 0, inverse_z_max = 0;  ///< 1/m
    std::array<float, 2> strays{};               ///< largest TreeSurface::strays of its nodes
};

/// Which part of a surface is hidden by nearer surfaces within a quadtree leaf.
enum class Hides : std::uint8_t {
    nothing,
    recorded,  ///< a part that is recorded as a hidden surface
    unknown    ///< a part that may not be recorded
};

/// A highlight: radiance above a limit, removed from a recorded surface. Instead, the highlight's impulse
/// response spreads this radiance over the image.
struct Highlight {
    float x = 0, y = 0;          ///< raster px
    std::array<float, 3> rgb{};  ///< radiance times px^2
    float area = 0;              ///< area of the surface that emits it, px^2
    Mat2 w;                      ///< 1/m
    float inverse_z = 0;         ///< 1/m
    float bend = 0;              ///< Record::w_bend
    /// Gradient of 1/z' over the raster, in 1/m per px, or 0 if no rays have measured it.
    glm::vec2 slope{0};
    std::uint32_t sheet = 0;
    Hides hides = Hides::nothing;

    /// Returns whether the radiance of the highlight is at least `radiance` in any channel. `rgb` is the
    /// radiance above the limit for highlights, times `area`.
    [[nodiscard]] bool exceeds(float radiance) const {
        return std::max({rgb[0], rgb[1], rgb[2]}) >= radiance * area;
    }
};

/// A texel (colour of one quadtree leaf) whose radiance exceeds the limit for highlights.
struct BrightTexel {
    std::uint32_t texel = 0;
    std::uint32_t first_light = 0, lights = 0;  ///< its elements of SheetMesh::bright
    float area = 1;                             ///< area of its leaf, px^2
    std::array<float, 3> rgb{};                 ///< colour of the texel without these highlights
};

struct SheetMesh {
    static constexpr int square_px = 16;  ///< edge of a sheet's square

    double time_s = 0;
    std::vector<Sheet> sheets;
    /// For each cell (raster pixel of a sheet), the root of its quadtree. `fine` has full detail. `coarse` is
    /// for surfaces that are blurred over several pixels. In `coarse`, a cell that the sheet covers
    /// completely is a single leaf.
    std::vector<std::uint32_t> fine, coarse;
    /// For each cell, `values` linear functions of the raster position, in 1/m, whose origin is the cell's
    /// centre. The first function is 1/z'. For surfaces seen by reflection or transmission, the entries xx,
    /// xy, yx and yy of the matrix W follow. W describes how the surface's image moves with the lens point.
    std::vector<CellPlane> planes;
    std::size_t values = 1;
    std::vector<float> bends;  ///< for each cell, its largest Record::w_bend; only if W is stored
    std::vector<std::uint32_t> nodes;
    std::vector<Texel> texels;
    /// For each texel (colour of a quadtree leaf), the radiance of its reflected and of its transmitted
    /// subtree (TreeSurface::below). Empty if no texel has child nodes.
    std::vector<std::array<std::array<float, 3>, 2>> below;
    /// `bright` contains the highlights: all radiance above a limit (HighlightRule::above). `bright_texels`
    /// lists the texels of `fine` and `coarse` that exceed the limit.
    std::vector<Highlight> bright;
    std::vector<BrightTexel> bright_texels;
    std::vector<Highlight> highlights;  ///< the elements of `bright` that have been taken out of the texels

    [[nodiscard]] bool has_w() const { return values == 5; }
};

/// The sheets (parts of surfaces) of one instant. `primary` contains surfaces that are seen directly, and
/// `deeper` contains surfaces that are seen by reflection or transmission.
struct TreeSheets {
    SheetMesh primary;
    SheetMesh deeper;  ///< its planes include W; empty if there are no such surfaces
};

/// The radiance of a sheet above the limit for highlights.
struct BrightSheet {
    float area_px2 = 0;
    Hides hides = Hides::nothing;  ///< what nearer surfaces hide in any of its leaves
};

/// Decides which bright surfaces become highlights, whose light is spread over the image by impulse
/// responses. A highlight consists of the radiance by which each channel exceeds `above`.
struct HighlightRule {
    float above = 1;
    /// Returns whether `light` becomes a highlight. `key` and `sheet` describe the sheet that it belongs to.
    /// If the function is empty, nothing becomes a highlight.
    std::function<bool(const Highlight& light, const SheetKey& key, const BrightSheet& sheet)> takes;
};
/// Returns, for each sheet of the mesh, the area whose radiance exceeds the limit for highlights, and whether
/// nearer surfaces hide parts of this area.
[[nodiscard]] std::vector<BrightSheet> bright_sheets(const SheetMesh& mesh);

/// Selects the sheets (parts of surfaces) of an instant that are needed. Others are not built. The selection
/// changes the indices of the sheets, but not their contents.
struct SheetChoice {
    /// Returns whether to read the row of raster squares (SheetMesh::square_px high) that begins at raster
    /// row y. If the function is empty, all rows are read.
    std::function<bool(int y)> rows;
    /// Removes sheets that are not needed from `some`. `some` contains the sheets of part number `part` of
    /// the row of raster squares that begins at raster row y. A part consists of `squares_per_part` squares,
    /// and parts are counted from the left. Several threads call the function, before highlights are taken
    /// out. If the function is empty, all sheets are needed.
    std::function<void(TreeSheets& some, int y, std::size_t part)> squares;
    bool deeper = true;  ///< whether reflected and transmitted nodes are needed
    /// Called for each row of squares that is not read (see `rows`) and begins at raster row y. Appends the
    /// needed sheets of this row, which an earlier reading has kept, to `parts`, from left to right.
    std::function<void(std::vector<TreeSheets>& parts, int y)> known;
    static constexpr int squares_per_part = 8;
};

/// Reads the sheets (parts of surfaces) of an instant from the file. The records that are read are also
/// passed to `also`. Throws Error(out_of_memory) if the sheets would not fit into memory. Exceptions of the
/// reader and of `also` are passed on.
[[nodiscard]] TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant,
                                     const HighlightRule& rule, const RecordsRead& also = {},
                                     const SheetChoice& choice = {});

/// Applies a new rule for highlights to existing sheets. Both rules must have the same limit `above`. The
/// result is bit-identical to the sheets that `tree_sheets` builds with the new rule.
void take_highlights(TreeSheets& sheets, const HighlightRule& rule);

}  // namespace postlens
