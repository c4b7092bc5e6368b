// Rounded CoC diameters, used as depth levels around the focus.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "lens/focus_geometry.h"

namespace postlens {

/// The CoC diameters for which blur kernels are computed. Others are rounded to the nearest. With growing
/// diameter, the steps grow from 1/8 px to half a pixel. Above `even_diameter_px`, they are 1/500 of the
/// diameter.
class LevelTable {
  public:
    static constexpr double even_diameter_px = 2048;
    /// Largest CoC diameter, in px. Larger ones are reduced to it.
    static constexpr double largest_diameter_px = 2e5;

    [[nodiscard]] static const LevelTable& the();

    /// Returns the CoC diameter of a depth level, in px.
    [[nodiscard]] static double diameter_px(std::uint32_t level);
    /// Returns the depth level (number of a blur kernel) whose CoC diameter is nearest to `diameter_px`. The
    /// sign of `diameter_px` is ignored, and it must be finite. Unlike level_of, this function computes the
    /// level without a table.
    [[nodiscard]] static std::uint32_t nearest_level(double diameter_px);
    /// Returns the depth level (number of a blur kernel) whose CoC diameter is nearest to `diameter_px`. The
    /// sign of `diameter_px` is ignored. For diameters below end_px, the level is read from a table, which is
    /// faster than computing it.
    [[nodiscard]] std::uint32_t level_of(double diameter_px) const {
        const double wide_px = std::abs(diameter_px);
        if (!(wide_px < end_px)) return nearest_level(wide_px);
        return level_in(static_cast<std::size_t>(static_cast<int>(wide_px * cells_per_px)), wide_px);
    }
    void levels_of(const FocusGeometry& geometry, const double* inverse_depth_per_m, std::size_t count,
                   std::uint32_t* level) const;

  private:
    LevelTable();
    [[nodiscard]] std::uint32_t level_in(std::size_t cell, double wide_px) const {
        return static_cast<std::uint32_t>(before_[cell] + (wide_px < begin_px_[cell] ? 0 : step_[cell]));
    }

    /// A table of the depth level (number of a blur kernel) that is nearest to each CoC diameter, from 0 to
    /// end_px, in px. It divides each px into cells_per_px cells. The level changes at most once in a cell.
    static constexpr int end_px = 128, cells_per_px = 32, cells = end_px * cells_per_px;
    /// For each cell: the diameter, in px, at which the level changes, the level at the cell's start, and the
    /// change of the level.
    std::array<double, cells> begin_px_{};
    std::array<std::int32_t, cells> before_{}, step_{};
};

}  // namespace postlens
