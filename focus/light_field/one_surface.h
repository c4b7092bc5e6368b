// Finds the parts of an image that show a single surface. Scattering is exact for these.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/scatter/splat_tables.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// One value per cell of `edge` x `edge` px of the window, row by row. 1: all lens points see a single object
/// in the cell, whose surface does not overlap itself and is not too steep for the lens. 0: all other cells,
/// for example with unrecorded parts or with reflected or transmitted nodes.
struct OneSurface {
    static constexpr int edge = 8;
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> cells;
    [[nodiscard]] bool at(int x, int y) const {
        return cells[static_cast<std::size_t>(y / edge) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(x / edge)] != 0;
    }
    /// Fraction of the cells that show a single surface (value 1).
    [[nodiscard]] double share() const;
    /// Whether every cell that overlaps a rectangle of the window shows a single surface.
    [[nodiscard]] bool all(int x, int y, int width, int height) const;
};

/// Computes a OneSurface from the patches (planar parts of surfaces) of an image. The patches may be added in
/// any order and in several parts.
class OneSurfaceFinder {
  public:
    /// `lens_px`: half the width and height of the lens's bounding box, m, times the gain (film distance /
    /// pixel pitch, px).
    OneSurfaceFinder(const glm::dvec2& lens_px, double inverse_focus_per_m, const RasterWindow& window);
    /// Adds patches of directly seen surfaces (`primary`), and of reflected and transmitted ones (`deeper`,
    /// which may be empty).
    void add(const PatchMesh& primary, const PatchMesh& deeper);
    [[nodiscard]] OneSurface found() const;

  private:
    glm::dvec2 lens_px_;
    double inverse_focus_per_m_;
    RasterWindow window_;
    int columns_, rows_;
    std::vector<std::uint32_t> owner_;
    std::vector<int> recorded_;  ///< per cell, recorded area of the patches, px^2
};

}  // namespace postlens
