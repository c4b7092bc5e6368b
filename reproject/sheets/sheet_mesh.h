// Groups the ray hits that `trace` recorded at one instant into sheets. A sheet is the part of one surface
// within a square of 16 x 16 px. For each pixel, the sheet stores a quadtree of colours and a plane that
// approximates the depths.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/records_read.h"
#include "records/sample_file.h"

namespace postlens {

/// Identifies a surface by its object, the sequence of reflections and transmissions by which it is seen, and
/// the mirror or glass in which it is seen. The part of a surface that lies closely behind another surface is
/// treated as a separate surface.
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
    /// Returns whether the colours at the corners of the quadtree cell are insufficient to determine the
    /// cell's colour. This is so if an outline, a gap, or the edge of a shadow or texture may cross the cell.
    [[nodiscard]] bool unsure() const { return (info & unsure_bit) != 0; }
    /// Returns whether the corners of the quadtree cell are insufficient to determine the light that the
    /// surface reflects or transmits in the cell, because the edge of a shadow or texture may appear in this
    /// light.
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

/// Tells what nearer surfaces hide of a surface inside a quadtree cell. The hidden part matters because other
/// lens points than the pinhole may see it. It can be drawn only if it was recorded.
enum class Hides : std::uint8_t {
    nothing,
    recorded,  ///< a part that is recorded as a hidden surface
    unknown    ///< a part that may not be recorded
};

/// Radiance of a recorded surface above a limit. It is removed from the surface, and the lens's point spread
/// function spreads it over the image. In the mean of a limited number of views, a very bright spot would
/// appear as separate dots.
struct Highlight {
    float x = 0, y = 0;          ///< raster px
    std::array<float, 3> rgb{};  ///< radiance times px^2
    float area = 0;              ///< area of the surface that emits it, px^2
    Mat2 w;                      ///< 1/m
    float inverse_z = 0;         ///< 1/m
    float bend = 0;              ///< Record::w_bend
    /// Gradient over the raster of the inverse depth of the surface that emits the highlight, in 1/m per px;
    /// 0 if unknown.
    glm::vec2 slope{0};
    std::uint32_t sheet = 0;
    Hides hides = Hides::nothing;

    /// True if the highlight's radiance in any channel is at least `radiance`. rgb is radiance times area.
    [[nodiscard]] bool exceeds(float radiance) const {
        return std::max({rgb[0], rgb[1], rgb[2]}) >= radiance * area;
    }
};

/// A texel (colour of a quadtree cell) that is brighter than the limit for highlights. The radiance above the
/// limit can be removed from the texel, and is stored separately as highlights.
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
    /// Root nodes of quadtrees of colours, as indices in `nodes`, for each pixel of each sheet (part of a
    /// surface). The quadtree in `fine` contains all recorded colours. The one in `coarse` is used where the
    /// lens blurs the surface. It has a single colour if the sheet covers the whole pixel.
    std::vector<std::uint32_t> fine, coarse;
    /// Linear functions of the offset from a pixel's centre, in px: `values` functions for each pixel of each
    /// sheet (part of a surface). The first gives the inverse depth, in 1/m. If `values` is 5, four more give
    /// the matrix W (Record::w), in 1/m.
    std::vector<CellPlane> planes;
    std::size_t values = 1;
    std::vector<float> bends;  ///< for each cell, its largest Record::w_bend; only if W is stored
    std::vector<std::uint32_t> nodes;
    std::vector<Texel> texels;
    /// RGB radiance that mirrors and glass send to the eye by reflection ([0]) and by transmission ([1]), for
    /// each recorded colour in `texels`. A colour in `texels` contains only the light of the surface itself.
    /// The list is empty if no surface reflects or transmits light.
    std::vector<std::array<std::array<float, 3>, 2>> below;
    /// Highlights: the part of the recorded radiance that exceeds the limit HighlightRule::above.
    /// `bright_texels` lists the colours of quadtree cells that exceed the limit, and tells which elements of
    /// `bright` belong to each of them.
    std::vector<Highlight> bright;
    std::vector<BrightTexel> bright_texels;
    std::vector<Highlight> highlights;  ///< the elements of `bright` that have been taken out of the texels

    [[nodiscard]] bool has_w() const { return values == 5; }
};

/// All surfaces recorded at one instant. Each surface is divided into sheets, one for each square of 16 x 16
/// px of the raster in which the surface appears. `primary` contains the sheets of surfaces that are seen
/// directly. `deeper` contains those of surfaces seen by reflection or transmission.
struct TreeSheets {
    SheetMesh primary;
    SheetMesh deeper;  ///< its planes include W; empty if there are no such surfaces
};

/// The radiance of a sheet above the limit for highlights.
struct BrightSheet {
    float area_px2 = 0;
    Hides hides = Hides::nothing;  ///< what nearer surfaces hide in any of its leaves
};

/// Decides which bright surfaces become highlights. The radiance of such a surface above the limit `above`,
/// in each colour channel, is removed from the surface. The lens's point spread function spreads this removed
/// radiance over the image instead.
struct HighlightRule {
    float above = 1;
    /// Returns whether `light`, the part of a quadtree cell's radiance above the limit `above`, becomes a
    /// highlight. `key` identifies the surface that the cell shows, and `sheet` describes its bright cells in
    /// the same square of 16 x 16 px. If `takes` is empty, there are no highlights.
    std::function<bool(const Highlight& light, const SheetKey& key, const BrightSheet& sheet)> takes;
};
/// Returns one element for each of mesh.sheets.
[[nodiscard]] std::vector<BrightSheet> bright_sheets(const SheetMesh& mesh);

/// Selects what tree_sheets reads from the file and keeps. An image may need only some of the sheets, which
/// are parts of surfaces within squares of 16 x 16 px. The selection changes the index of a sheet, but not
/// its contents.
struct SheetChoice {
    /// Returns whether a row of squares (16 x 16 px of the raster) is read from the file. `y` is the first
    /// raster row of this row of squares. If the function is empty, all rows are read.
    std::function<bool(int y)> rows;
    /// Optional function that deletes surfaces that the caller does not need. `some` holds the surfaces in up
    /// to 8 adjacent squares (16 x 16 px). `y` is the first raster row of these squares, and `part` is the
    /// index of their group in the row. Several threads may call it at once.
    std::function<void(TreeSheets& some, int y, std::size_t part)> squares;
    bool deeper = true;  ///< whether reflected and transmitted nodes are needed
    /// Optional function that supplies surfaces read earlier. It is called for each row of squares (16 x 16
    /// px) for which `rows` returns false. `y` is the first raster row of these squares. The function appends
    /// their surfaces to `parts`, from left to right.
    std::function<void(std::vector<TreeSheets>& parts, int y)> known;
    static constexpr int squares_per_part = 8;
};

/// Reads the surfaces recorded at one instant from a sample file, and divides them into sheets (parts of
/// surfaces within squares of 16 x 16 px). The functions in `also` get all records that are read. Throws
/// Error(out_of_memory), and exceptions of the reader and of `also`.
[[nodiscard]] TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant,
                                     const HighlightRule& rule, const RecordsRead& also = {},
                                     const SheetChoice& choice = {});

/// Selects the highlights (bright radiance that is removed from surfaces) anew by another rule, and undoes
/// the earlier selection. The result is bit-identical to that of tree_sheets, which builds `sheets`, with the
/// new rule. The limit of radiance, `rule.above`, must be the same as when `sheets` were built.
void take_highlights(TreeSheets& sheets, const HighlightRule& rule);

}  // namespace postlens
