// The levels around the focus: how wide the circles of each are, and which one a circle belongs to.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "lens/focus_geometry.h"

namespace postlens {

/// From a diameter of 0.4 px on levels are an eighth of a pixel apart, then a fiftieth of the diameter, then
/// half a pixel; from `even_diameter_px` on the steps grow with the circle, to a 500th of it. A circle
/// belongs to the nearest. One table serves all lenses.
class LevelTable {
  public:
    static constexpr double even_diameter_px = 2048;
    /// What is wider belongs to the level of this.
    static constexpr double largest_diameter_px = 2e5;

    [[nodiscard]] static const LevelTable& the();

    /// Of the circles of a level, px.
    [[nodiscard]] static double diameter_px(std::uint32_t level);
    /// By its definition, with logarithms. `diameter_px` may be negative, as level_of's, and is finite.
    [[nodiscard]] static std::uint32_t nearest_level(double diameter_px);
    /// The same, from the table as far as that goes.
    [[nodiscard]] std::uint32_t level_of(double diameter_px) const {
        const double wide_px = std::abs(diameter_px);
        if (!(wide_px < end_px)) return nearest_level(wide_px);
        return level_in(static_cast<std::size_t>(static_cast<int>(wide_px * cells_per_px)), wide_px);
    }
    /// level_of the CoC of each inverse depth, 1/m.
    void levels_of(const FocusGeometry& geometry, const double* inverse_depth_per_m, std::size_t count,
                   std::uint32_t* level) const;

  private:
    LevelTable();
    [[nodiscard]] std::uint32_t level_in(std::size_t cell, double wide_px) const {
        return static_cast<std::uint32_t>(before_[cell] + (wide_px < begin_px_[cell] ? 0 : step_[cell]));
    }

    /// So narrow that no more than one level begins in a cell.
    static constexpr int end_px = 128, cells_per_px = 32, cells = end_px * cells_per_px;
    /// By cell: the diameter where a level begins, the level before, and by how much that one is above it.
    std::array<double, cells> begin_px_{};
    std::array<std::int32_t, cells> before_{}, step_{};
};

}  // namespace postlens
