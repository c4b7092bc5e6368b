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
    /// Returns the index of the first cell in a row of strata. row_begin(rows()) is n.
    [[nodiscard]] std::uint32_t row_begin(std::uint32_t row) const {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>(row) * n_ / rows_);
    }

    /// Writes the stratified points of samples [first, first + lanes), where lanes is 16 or 1.
    /// Sample i is in cell i or, with `permuted`, in a random cell that `key` selects.
    /// Samples with an index of n or more are in the cell of sample n - 1.
    void fill_2d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u, float* v) const;
    /// Writes one-dimensional points, one in each of n equal intervals of [0, 1). Arguments as for fill_2d.
    void fill_1d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u) const;

  private:
    std::uint32_t n_, rows_;
};

}  // namespace postlens
