// Finds the parts of an image in which all lens points see the same single surface. The method `scatter`,
// which ignores what hides what, is exact there.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/scatter/splat_tables.h"
#include "reproject/patches/patches.h"

namespace postlens {

/// For each cell of an image, a square of `edge` x `edge` px: whether all lens points see the same single
/// surface there. Surfaces that overlap themselves in the image, or that look different from different lens
/// points because they are steep, do not count.
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
    /// `lens_px` describes the lens: how far the image of a surface is displaced, in x and in y, if the lens
    /// point moves from the lens's centre to its rim. It is in px, per 1/m of difference between the
    /// surface's inverse depth and `inverse_focus_per_m`.
    /// - `inverse_focus_per_m`: inverse focus distance, in 1/m
    /// - `window`: the pixels of the image
    OneSurfaceFinder(const glm::dvec2& lens_px, double inverse_focus_per_m, const RasterWindow& window);
    /// Adds surfaces of the sample file. All surfaces that any lens point may see must be added, because
    /// found() assumes that there are no others.
    /// - `primary`: surfaces that are seen directly, divided into planar parts
    /// - `deeper`: surfaces that are seen in mirrors or through glass; may be empty
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
