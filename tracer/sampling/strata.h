// Stratified points: one point in each of n cells of equal area [cook1984].
#pragma once

#include <cstdint>

#include "core/sample_hash.h"

namespace postlens {

enum class CellPoint { centre, random };

/// Divides the unit square into n cells of area 1/n, for any n in 1 .. 2^20, numbered row by row.
/// There are round(sqrt(n)) rows, whose numbers of cells differ by at most one.
/// The height of a row is proportional to its number of cells.
class Strata {
  public:
    explicit Strata(std::uint32_t n);
    [[nodiscard]] std::uint32_t count() const { return n_; }
    [[nodiscard]] std::uint32_t rows() const { return rows_; }
    /// The unit square is divided into `rows()` rows and n cells. The cells are numbered row by row, and some
    /// rows have one cell more than others. Returns the number of the first cell in row `row`;
    /// row_begin(rows()) is n.
    [[nodiscard]] std::uint32_t row_begin(std::uint32_t row) const {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>(row) * n_ / rows_);
    }

    /// Writes one point of the unit square for each of the samples first .. first + lanes - 1 of a pixel. The
    /// square is divided into n cells of area 1/n, and each of the pixel's n samples has its own cell.
    /// - `where`: whether a point is the centre of its cell or a random point in it
    /// - `permuted`: the cells are assigned to the samples in random order
    /// - `lanes`: 1 or 16
    /// - `u`, `v`: receive the points' coordinates
    void fill_2d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u, float* v) const;
    /// Writes one number in [0, 1) to `u` for each of the samples first .. first + lanes - 1 of a pixel,
    /// where `lanes` is 1 or 16. [0, 1) is divided into n equal intervals, and each of the pixel's n samples
    /// has its own interval. `where` selects the interval's centre or a random number in it. If `permuted`,
    /// the intervals are assigned to the samples in random order.
    void fill_1d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u) const;

  private:
    std::uint32_t n_, rows_;
};

}  // namespace postlens
