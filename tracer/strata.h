// Stratified points: n cells of equal area, a point in each [cook1984].
#pragma once

#include <cstdint>

#include "core/sample_hash.h"

namespace postlens {

/// Where in its cell a point lies.
enum class CellPoint { centre, random };

/// n cells of area 1/n of the unit square, for any n in 1 .. 2^20: round(sqrt(n)) rows whose numbers of cells
/// differ by at most one, each row as high as its share of the cells. Cells are counted row by row.
class Strata {
  public:
    explicit Strata(std::uint32_t n);
    [[nodiscard]] std::uint32_t count() const { return n_; }
    [[nodiscard]] std::uint32_t rows() const { return rows_; }
    /// The first cell of a row; row = rows() gives n.
    [[nodiscard]] std::uint32_t row_begin(std::uint32_t row) const {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>(row) * n_ / rows_);
    }

    /// Points of samples first .. first + lanes - 1, lanes = 16 or 1; samples from n on repeat the last.
    /// Edges of cells are rounded up to multiples of 2^-24, so that the points, which are such multiples,
    /// never leave their cell. `permuted`: sample i is in cell p(i) of a random permutation p of this key,
    /// else in cell i.
    void fill_2d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u, float* v) const;
    /// The same for n equal intervals of [0, 1).
    void fill_1d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u) const;

  private:
    std::uint32_t n_, rows_;
};

}  // namespace postlens
