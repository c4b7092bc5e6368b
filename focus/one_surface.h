// Where a picture through a lens shows one surface only, so that spreading what is visible is all there is to
// do.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/splat_tables.h"
#include "reproject/patches.h"

namespace postlens {

/// By cells of `edge` px of the window, row by row: 1 where light of no more than one id arrives, from all
/// points of the lens, and that surface is seen once and nowhere at a slant that the lens would show; 0
/// elsewhere, where nothing arrives, and where something is seen in mirrors or through glass.
struct OneSurface {
    static constexpr int edge = 8;
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> cells;
    [[nodiscard]] bool at(int x, int y) const {
        return cells[static_cast<std::size_t>(y / edge) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(x / edge)] != 0;
    }
    /// Of the cells.
    [[nodiscard]] double share() const;
    /// Whether all of a rectangle of the window is such.
    [[nodiscard]] bool all(int x, int y, int width, int height) const;
};

/// Finds it from the patches of a picture, which may come in any order and any number at a time.
class OneSurfaceFinder {
  public:
    /// `lens_px`: half the width and height of the lens's box, times film distance / pitch, px m.
    OneSurfaceFinder(const glm::dvec2& lens_px, double inverse_focus_per_m, const RasterWindow& window);
    /// `deeper` may be empty.
    void add(const PatchMesh& primary, const PatchMesh& deeper);
    [[nodiscard]] OneSurface found() const;

  private:
    glm::dvec2 lens_px_;
    double inverse_focus_per_m_;
    RasterWindow window_;
    int columns_, rows_;
    std::vector<std::uint32_t> owner_;
    std::vector<int> recorded_;  ///< px^2 of the recorded patches that lie there, unmoved
};

}  // namespace postlens
