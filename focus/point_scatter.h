// Scattering splats one by one: each costs as much as its outline in the rows concerned.
#pragma once

#include <array>
#include <vector>

#include "focus/splat_tables.h"

namespace postlens {

/// Sums of colour times response (channels 0..2) and of weight times response (3) over a few pixel rows of
/// one block.
///
/// The outline of a response is added pixel by pixel; its inside, where it is wide, as a difference: once
/// where a row of it begins and once, subtracted, where it ends. Both in double: a difference of float sums
/// would leave a trace of every bright light to the right of it.
class PointScatter {
  public:
    /// `channel`: whose kernels, where the response has channels.
    explicit PointScatter(const SplatTables& tables, std::size_t channel = 0)
        : tables_(tables), channel_(channel) {}

    /// Adds all splats that reach the rows, which lie in tables.picture(), to sums that start from zero.
    /// False where none does: then there are no sums. Buffers are kept from call to call.
    bool run(const RasterWindow& rows);

    /// The sums of row y, pixel by pixel, four channels each.
    [[nodiscard]] const double* sums(int y) const {
        return sum_.data() + 4 * static_cast<std::size_t>(y - rows_.y_begin) * stride_;
    }

  private:
    bool add_class(std::size_t reach_class, bool begun);

    const SplatTables& tables_;
    std::size_t channel_;
    RasterWindow rows_;
    std::size_t stride_ = 0;  ///< pixels from row to row: one more than there are, for what ends there
    std::vector<double> sum_;
    std::vector<double> change_;  ///< from the pixel to the left
};

}  // namespace postlens
