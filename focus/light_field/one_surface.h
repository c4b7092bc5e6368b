// Finds the parts of an image in which all lens points see the same single surface. The method `scatter`,
// which ignores what hides what, is exact there.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/scatter/splat_tables.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// States for each cell (square of `edge` x `edge` px) of an image whether all lens points see the same
/// single surface there. A surface does not count if it covers a pixel twice, or is too steep.
struct OneSurface {
    static constexpr int edge = 8;
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> cells;
    [[nodiscard]] bool at(int x, int y) const {
        return cells[static_cast<std::size_t>(y / edge) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(x / edge)] != 0;
    }
    /// Returns the fraction of the image's cells (squares of `edge` x `edge` px) that show a single surface.
    [[nodiscard]] double share() const;
    [[nodiscard]] bool all(int x, int y, int width, int height) const;
};

/// Finds the parts of an image in which all lens points see a single surface. First, call `add` with the
/// planar parts of all recorded surfaces, in one or several calls; then, call `found`.
class OneSurfaceFinder {
  public:
    /// `lens_px`: largest displacement of a surface's image, in x and in y, by a displacement of the lens
    /// point. In px per 1/m of difference from the inverse focus distance.
    OneSurfaceFinder(const glm::dvec2& lens_px, double inverse_focus_per_m, const RasterWindow& window);
    /// Adds planar parts of surfaces that the lens may see: `primary` directly, `deeper` in mirrors or
    /// through glass (may be empty).
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
