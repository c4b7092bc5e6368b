// Groups the records of one instant into sheets. A sheet is the part of one surface within a square of 16 x
// 16 px. For each pixel, the sheet stores a quadtree of colours and a plane that approximates the depths.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

/// Identifies a surface by four values: its object, the sequence of reflections and transmissions by which it
/// is seen, the mirror or glass in which it is seen, and whether it lies closely behind another surface.
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

/// A linear function `value + x * dx + y * dy` of the offset (dx, dy), in px, from an origin. Each list of
/// such functions states its origin.
struct CellPlane {
    float value = 0, x = 0, y = 0;
};

/// Colour and flags of a quadtree leaf.
struct Texel {
    float r = 0, g = 0, b = 0;  ///< scene-linear radiance of this node, without its children
    std::uint32_t info = 0;     ///< as `info_of` packs it
    [[nodiscard]] static constexpr std::uint32_t info_of(std::uint32_t sheet, std::uint8_t children,
                                                         std::uint32_t unsure = 0) {
        return sheet << sheet_shift | unsure | children;
    }
    static constexpr std::uint32_t sheet_shift = 4, children_bits = 3, unsure_bit = 4, unsure_below_bit = 8;
    [[nodiscard]] std::uint32_t sheet() const { return info >> sheet_shift; }
    /// Returns the bits (child_bit) of the surface's recorded reflection and refraction.
    [[nodiscard]] std::uint8_t children() const { return static_cast<std::uint8_t>(info & children_bits); }
    /// True if an outline, a gap, or the edge of a shadow or texture may cross the quadtree cell. The corners
    /// of the cell then do not determine its colour.
    [[nodiscard]] bool unsure() const { return (info & unsure_bit) != 0; }
    /// True if the reflected or transmitted light in the quadtree cell may contain the edge of a shadow or
    /// texture.
    [[nodiscard]] bool unsure_below() const { return (info & unsure_below_bit) != 0; }
    [[nodiscard]] std::uint32_t unsure_bits() const { return info & (unsure_bit | unsure_below_bit); }
};

/// A sheet (part of a surface) stores a quadtree of colours for each pixel. Node of this quadtree:
/// - `none`: the surface is absent
/// - `maybe`: the surface may be present or absent, because an edge crosses the cell
/// - with the bit `leaf`: index of its colour (Texel)
/// - otherwise: index of its first child, in the order up-left, up-right, down-left, down-right
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

/// Whether nearer surfaces hide a part of a surface inside a quadtree cell, and whether this hidden part is
/// recorded.
enum class Hides : std::uint8_t {
    nothing,
    recorded,  ///< a part that is recorded as a hidden surface
    unknown    ///< a part that may not be recorded
};

/// Radiance above a limit, removed from a recorded surface. The lens's point spread function spreads it over
/// the image instead.
struct Highlight {
    float x = 0, y = 0;          ///< raster px
    std::array<float, 3> rgb{};  ///< radiance times px^2
    float area = 0;              ///< area of the surface that emits it, px^2
    Mat2 w;                      ///< 1/m
    float inverse_z = 0;         ///< 1/m
    float bend = 0;              ///< Record::w_bend
    /// Gradient of inverse depth over the raster, in 1/m per px; 0 if unknown.
    glm::vec2 slope{0};
    std::uint32_t sheet = 0;
    Hides hides = Hides::nothing;

    /// True if the highlight's radiance in any channel is at least `radiance`. rgb is radiance times area.
    [[nodiscard]] bool exceeds(float radiance) const {
        return std::max({rgb[0], rgb[1], rgb[2]}) >= radiance * area;
    }
};

/// The colour (texel) of a quadtree cell whose radiance exceeds the limit for highlights.
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
    /// A sheet is a part of a surface. For each of its pixels, root nodes of two quadtrees of colours: `fine`
    /// has all recorded colours. `coarse`, for blurred surfaces, has one colour per fully covered pixel.
    std::vector<std::uint32_t> fine, coarse;
    /// For each pixel of each sheet: `values` linear functions of the offset from the pixel's centre. The
    /// first is the inverse depth (1/m). If `values` is 5, the rest are the entries of the 2x2 matrix
    /// Record::w.
    std::vector<CellPlane> planes;
    std::size_t values = 1;
    std::vector<float> bends;  ///< for each cell, its largest Record::w_bend; only if W is stored
    std::vector<std::uint32_t> nodes;
    std::vector<Texel> texels;
    /// For each colour in `texels`: the radiance that its surface additionally sends to the eye by reflection
    /// ([0]) and transmission ([1]). Empty if no surface reflects or transmits light.
    std::vector<std::array<std::array<float, 3>, 2>> below;
    /// Highlights: that part of the recorded radiance that exceeds HighlightRule::above. `bright_texels`
    /// lists the quadtree cells whose radiance exceeds it.
    std::vector<Highlight> bright;
    std::vector<BrightTexel> bright_texels;
    std::vector<Highlight> highlights;  ///< the elements of `bright` that have been taken out of the texels

    [[nodiscard]] bool has_w() const { return values == 5; }
};

/// All surfaces recorded at one instant. Each surface is divided into sheets, one for each square of 16 x 16
/// px. `primary` has the surfaces that are seen directly, `deeper` those seen by reflection or transmission.
struct TreeSheets {
    SheetMesh primary;
    SheetMesh deeper;  ///< its planes include W; empty if there are no such surfaces
};

/// The radiance of a sheet above the limit for highlights.
struct BrightSheet {
    float area_px2 = 0;
    Hides hides = Hides::nothing;  ///< what nearer surfaces hide in any of its leaves
};

/// Decides which bright surfaces become highlights. Their radiance beyond `above`, per channel, is then
/// spread over the image by the lens's point spread function.
struct HighlightRule {
    float above = 1;
    /// Returns whether `light`, the radiance of a quadtree cell beyond `above`, becomes a highlight. `key`
    /// and `sheet` describe the cell's surface. If empty, nothing becomes a highlight.
    std::function<bool(const Highlight& light, const SheetKey& key, const BrightSheet& sheet)> takes;
};
/// Returns one element for each of mesh.sheets.
[[nodiscard]] std::vector<BrightSheet> bright_sheets(const SheetMesh& mesh);

/// An image may need only some sheets (surfaces within squares of the raster). This selects the sheets that
/// are built. The selection changes the sheets' indices, but not their contents.
struct SheetChoice {
    /// Returns whether the row of squares (16 x 16 px) that begins at raster row y is read. An empty function
    /// means that all rows are read.
    std::function<bool(int y)> rows;
    /// Optional: removes surfaces that the caller does not need. `some` has the surfaces of up to 8 adjacent
    /// squares (16 x 16 px), part number `part` of the row of squares from raster row y on. Called by several
    /// threads.
    std::function<void(TreeSheets& some, int y, std::size_t part)> squares;
    bool deeper = true;  ///< whether reflected and transmitted nodes are needed
    /// Optional: called for each row of squares that `rows` leaves out because the caller already has its
    /// surfaces. Appends these surfaces to `parts`, left to right.
    std::function<void(std::vector<TreeSheets>& parts, int y)> known;
    static constexpr int squares_per_part = 8;
};

/// Reads the surfaces recorded at one instant from a sample file, and divides them into sheets (parts within
/// squares of the raster). To avoid a second reading, `also` gets all records that are read. Throws
/// Error(out_of_memory), and exceptions of the reader and of `also`.
[[nodiscard]] TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant,
                                     const HighlightRule& rule, const RecordsRead& also = {},
                                     const SheetChoice& choice = {});

/// Selects highlights again, by a new rule with the old radiance limit `above`. The result is bit-identical
/// to that of calling tree_sheets with the new rule.
void take_highlights(TreeSheets& sheets, const HighlightRule& rule);

}  // namespace postlens
