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
    /// Computes the depth level (number of a blur kernel) nearest to a CoC diameter, without the lookup
    /// table. `diameter_px` must be finite; its sign is ignored.
    [[nodiscard]] static std::uint32_t nearest_level(double diameter_px);
    /// Returns the depth level whose CoC diameter is nearest to `diameter_px`. The sign of `diameter_px` is
    /// ignored. Below end_px, the level is read from a table, because this is faster.
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

    /// A table contains the depth level (number of a blur kernel) that is nearest to a CoC diameter. It
    /// covers diameters up to end_px, in px, and has cells_per_px cells per px. Within each cell, the level
    /// changes at most once.
    static constexpr int end_px = 128, cells_per_px = 32, cells = end_px * cells_per_px;
    std::array<double, cells> begin_px_{};
    std::array<std::int32_t, cells> before_{}, step_{};
};

}  // namespace postlens
