// Merges the many small squares of light that a bright surface is recorded as into fewer light sources.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <tuple>
#include <vector>

#include "focus/responses/kernel.h"
#include "lens/focus_geometry.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// A highlight is sharp if its smallest blur radius is below this, in px. If the blur is larger, images from
/// single lens points show the highlight at separate positions, and their mean shows separate dots.
constexpr double sharp_below_px = 2;

/// Highlights whose blur radius is below this in all directions, in px, count as points (is_point).
constexpr double point_below_px = 1.0 / KernelKey::phase_steps;

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
struct SourcePart {
    glm::vec2 at{0}, size{0};
    float area_until = 0;
};

/// Returns the matrix that converts a lens point, in lens radii, to the displacement of a highlight's image,
/// in px.
[[nodiscard]] glm::dmat2 px_from_lens(const Highlight& h, const FocusGeometry& geometry);

/// Returns whether the blur of a highlight is smaller than 1/16 px, the step to which the positions of blur
/// kernels are rounded. Such a highlight is treated as a point: all of its light in a pixel becomes one light
/// source, and rounding must not move this light to a neighbouring pixel.
[[nodiscard]] bool is_point(const Highlight& h, const FocusGeometry& geometry);

/// Returns how far the inclination of a surface shifts the centre of its highlight's blur, in px. An inclined
/// surface looks larger from one side of the lens, and sends more light through this side. So its blur is not
/// centred.
[[nodiscard]] glm::dvec2 inclination_shift_px(const Highlight& h, const FocusGeometry& geometry);

/// Merges highlights into light sources, so that fewer blur kernels are added to the image. Highlights are
/// merged if they belong to the same surface and lie in the same small square cell of the raster. Cells are
/// as large as the radiance allows without visible error.
class MergedHighlights {
  public:
    struct Merged {
        Highlight light;  ///< position and depth: means, weighted by light
        double energy = 0;
        std::vector<SourcePart> parts;
    };
    /// `geometry` must outlive this object.
    explicit MergedHighlights(const FocusGeometry& geometry) : geometry_(geometry) {}

    /// Adds a highlight of a static surface. Highlights in the same square cell of the raster are merged into
    /// one light source. Where the blur is sharp, merging would change the shape of the light if highlights
    /// extended over several cells. Therefore, a sharp highlight is first divided at the borders of the
    /// cells.
    /// - `sheet_area_px2`: area of all highlights of the same sheet (part of a surface within 16 x 16 px)
    void add(const Highlight& h, float sheet_area_px2);
    /// Adds a highlight of a moving surface. Cells are `cell_px` wide.
    void add_moving(const Highlight& h, double cell_px);

    /// Key: sheet, cells per pixel, column and row of the cell.
    [[nodiscard]] const std::map<std::tuple<std::uint32_t, int, int, int>, Merged>& all() const {
        return merged_;
    }

  private:
    /// `first_px`: position of one corner of a cell
    void merge(const Highlight& h, const glm::vec2& size, double cell_px, const glm::dvec2& first_px);
    const FocusGeometry& geometry_;
    std::map<std::tuple<std::uint32_t, int, int, int>, Merged> merged_;
};

}  // namespace postlens
