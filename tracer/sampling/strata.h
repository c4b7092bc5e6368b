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
    /// The n cells are numbered row by row. Returns the number of the first cell in a row. row_begin(rows())
    /// is n.
    [[nodiscard]] std::uint32_t row_begin(std::uint32_t row) const {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>(row) * n_ / rows_);
    }

    /// Writes one point for each of the samples first .. first + lanes - 1. Each of the n samples has its own
    /// cell of the unit square, and all cells have the area 1/n.
    /// - `permuted`: the cells are assigned to the samples in random order
    /// - `lanes`: 1 or 16
    void fill_2d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u, float* v) const;
    /// Like fill_2d, but for one dimension: [0, 1) is divided into n equal intervals, one for each sample of
    /// a pixel. `u` receives the samples' points.
    void fill_1d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u) const;

  private:
    std::uint32_t n_, rows_;
};

}  // namespace postlens
