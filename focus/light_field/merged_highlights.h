// Merges the highlights of a bright surface into fewer light sources, to save time. The highlights are small
// squares, one for each sample of the surface in the sample file.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <tuple>
#include <vector>

#include "lens/focus_geometry.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// A highlight is sharp if its blur radius is below this, in px, in the direction in which it is smallest.
/// With more blur, the mean of images from many lens points would show the highlight as separate dots, so
/// such highlights need a blur kernel. A sharp highlight gets one only if it is small.
constexpr double sharp_below_px = 2;

/// A part of an interval, and its share of the whole.
struct Span {
    double middle, share;
};
/// Divides the interval of length `length` around `middle` at the borders of cells. Cell i extends from first
/// + i * cell to first + (i + 1) * cell.
[[nodiscard]] std::vector<Span> divided_at_cells(double middle, double length, double cell, double first = 0);

/// A rectangle of bright light. A light source consists of one or more such rectangles. The running sum of
/// their areas serves to choose a random point of the light source.
/// - `at`: centre, in px; a raster position in MergedHighlights, but relative to the light source in
///   FieldHighlights
/// - `area_until`: total area of this rectangle and all rectangles before it in the light source, in px^2
/// - `light`: radiance times px^2, summed over the colour channels
struct SourcePart {
    glm::vec2 at{0}, size{0};
    float area_until = 0;
    float light = 0;
};

/// Returns the matrix that converts a lens point, in lens radii, to the displacement of a highlight's image,
/// in px.
[[nodiscard]] glm::dmat2 px_from_lens(const Highlight& h, const FocusGeometry& geometry);

/// Returns how far the inclination of a surface shifts the centre of its highlight's blur, in px. An inclined
/// surface looks larger from one side of the lens, and sends more light through this side. So its blur is not
/// centred.
[[nodiscard]] glm::dvec2 inclination_shift_px(const Highlight& h, const FocusGeometry& geometry);

/// Merges highlights into light sources, so that fewer blur kernels are added to the image. Highlights are
/// merged if they belong to the same surface and lie in the same small square cell of the raster. Cells of
/// blurred highlights are as large as the radiance allows without visible error.
class MergedHighlights {
  public:
    struct Merged {
        Highlight light;  ///< position and depth: means, weighted by light
        double energy = 0;
        std::vector<SourcePart> parts;
        bool is_sharp = false;
    };
    /// `geometry` must outlive this object.
    explicit MergedHighlights(const FocusGeometry& geometry) : geometry_(geometry) {}

    /// Adds a highlight of a static surface. Highlights in the same square cell of the raster are merged into
    /// one light source. If the highlight is almost sharp (`is_sharp`), it is first divided at the borders of
    /// the cells, so that each of its parts lies in one cell. The borders of pixels are borders of cells.
    void add(const Highlight& h, bool is_sharp);
    /// Adds a highlight of a moving surface. Cells are `cell_px` wide.
    void add_moving(const Highlight& h, double cell_px);

    /// Key: sheet, cells per pixel (negative for almost sharp highlights), column and row of the cell.
    [[nodiscard]] const std::map<std::tuple<std::uint32_t, int, int, int>, Merged>& all() const {
        return merged_;
    }

  private:
    struct Cells {
        double width_px;
        glm::dvec2 first_px{0};  ///< position of one corner of a cell
        bool is_sharp = false;
    };
    void merge(const Highlight& h, const glm::vec2& size, const Cells& cells);
    const FocusGeometry& geometry_;
    std::map<std::tuple<std::uint32_t, int, int, int>, Merged> merged_;
};

}  // namespace postlens
