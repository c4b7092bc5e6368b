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

/// One of the rectangles of light that are merged into one light source.
/// - `at`: centre, px; in MergedHighlights in the raster, in FieldHighlights relative to the light source
/// - `area_until`: sum of the areas of the light source's rectangles up to this one, px^2
struct SourcePart {
    glm::vec2 at{0}, size{0};
    float area_until = 0;
};

/// Returns the matrix that converts a lens point, in lens radii, to the displacement of a highlight's image,
/// in px.
[[nodiscard]] glm::dmat2 px_from_lens(const Highlight& h, const FocusGeometry& geometry);

/// Returns whether the blur of a highlight is so small that all light that falls into a pixel may be moved to
/// the pixel's interior.
[[nodiscard]] bool is_point(const Highlight& h, const FocusGeometry& geometry);

/// An inclined surface looks larger from one side of the lens, and sends more light through this side.
/// Returns how far this shifts the centre of the surface's blur, in px.
[[nodiscard]] glm::dvec2 inclination_shift_px(const Highlight& h, const FocusGeometry& geometry);

/// Highlights of the same surface and the same small cell of the raster, merged into one light source. Cells
/// are as large as the radiance allows without visible error.
class MergedHighlights {
  public:
    struct Merged {
        Highlight light;  ///< position and depth: means, weighted by light
        double energy = 0;
        std::vector<SourcePart> parts;
    };
    /// `geometry` must outlive this object.
    explicit MergedHighlights(const FocusGeometry& geometry) : geometry_(geometry) {}

    /// Adds a highlight of a static surface. A sharp highlight is divided at the borders of the cells in
    /// which highlights are merged, so that merging keeps the shape of its light.
    /// - `sheet_area_px2`: area of all highlights of the same sheet
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
