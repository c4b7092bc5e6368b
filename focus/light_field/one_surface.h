// Finds the parts of an image in which all lens points see the same single surface. The method `scatter`,
// which ignores what hides what, is exact there.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/scatter/splat_tables.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// States for each cell of an image, a square of `edge` x `edge` px, whether all lens points see the same
/// single surface there. This is not the case if the surface covers a pixel twice, or if it is too steep.
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
    /// If the lens point moves away from the centre, the image of a surface is displaced in proportion to the
    /// difference between the surface's inverse depth and the inverse focus distance. `lens_px` is the
    /// largest such displacement, in x and in y, in px per 1/m of this difference.
    /// - `inverse_focus_per_m`: inverse focus distance, in 1/m
    /// - `window`: the pixels of the image
    OneSurfaceFinder(const glm::dvec2& lens_px, double inverse_focus_per_m, const RasterWindow& window);
    /// Adds recorded surfaces that the lens may see, as planar parts. `primary` contains the surfaces that
    /// are seen directly, and `deeper` those that are seen in mirrors or through glass. `deeper` may be
    /// empty.
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
