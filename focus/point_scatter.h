// Scattering splats one by one: each costs as much as its outline in the rows concerned.
#pragma once

#include <cstddef>
#include <span>
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
    /// Buffers are kept from call to call.
    void run(const RasterWindow& rows);

    /// The part of the rows that splats may reach; empty where none does. Beyond it sums are zero, and not
    /// there.
    [[nodiscard]] const RasterWindow& reached() const { return reached_; }
    [[nodiscard]] bool reaches(int y) const { return y >= reached_.y_begin && y < reached_.y_end; }
    /// The four channels' sums at a pixel of what is reached; those of its row follow.
    [[nodiscard]] const double* sums(int x, int y) const { return sum_.data() + index(x, y); }

  private:
    /// Splats of a row, of one reach class, that may reach the rows.
    struct Pass {
        std::span<const Splat> splats;
        int y;
    };
    void find_passes(std::size_t reach_class);
    [[nodiscard]] std::size_t index(int x, int y) const {
        return 4 * (static_cast<std::size_t>(y - rows_.y_begin) * stride_ +
                    static_cast<std::size_t>(x - rows_.x_begin));
    }

    const SplatTables& tables_;
    std::size_t channel_;
    RasterWindow rows_, reached_;
    std::vector<Pass> passes_;
    std::size_t stride_ = 0;      ///< pixels from row to row: one more than there are, for what ends there
    std::vector<double> sum_;     ///< of rows_; what is not reached holds what was there before
    std::vector<double> change_;  ///< from the pixel to the left
};

}  // namespace postlens
