#include "tracer/sampling/strata.h"

#include <cassert>
#include <cmath>

#include "core/multiversion.h"
#include "tracer/sampling/permutation.h"

namespace postlens {
namespace {

struct StrataTask {
    SetKey key;
    CellPoint where;
    bool permuted;
    std::uint32_t n, rows, first;
};

/// Divides integers by multiplying by the reciprocal, and rounds down. Adding 0.5 to the dividend makes the
/// result exact for divisors up to 2^20 and quotients up to 2^24.
struct Divisor {
    explicit Divisor(double d) : value(d), inverse(1 / d) {}
    double value, inverse;
    [[nodiscard, gnu::always_inline]] std::int32_t rounded_down(double a) const {
        return static_cast<std::int32_t>((a + 0.5) * inverse);
    }
    /// Returns the lower edge of interval number `cell` if [0, 1) is divided into `value` equal intervals.
    /// The result is in units of 2^-24, rounded up.
    [[nodiscard, gnu::always_inline]] std::int32_t edge(double cell) const {
        // Computes ceil(a / d) as floor((a + d - 1) / d), where a = cell * 2^24 and d = `value`. The product
        // with `inverse`, which is 1 / d, may have a rounding error. To be safe from it, 0.5 is added before
        // the division, so d - 1 becomes d - 0.5.
        return static_cast<std::int32_t>((cell * 0x1p24 + (value - 0.5)) * inverse);
    }
};

/// Returns the integer at the fraction `share`, in [0, 1), of the interval [begin, end), rounded down.
[[gnu::always_inline]] inline std::int32_t between(std::int32_t begin, std::int32_t end, double share) {
    return begin + static_cast<std::int32_t>(share * (end - begin));
}

template <int lanes>
[[gnu::always_inline]] inline void cells(const StrataTask& t, std::uint32_t* cell) {
    for (int i = 0; i < lanes; ++i) {
        const std::uint32_t index = t.first + static_cast<std::uint32_t>(i);
        cell[i] = index < t.n ? index : t.n - 1;
    }
    if (t.permuted) Permutation(t.n, t.key.stream(0)).permute<lanes>(cell);
}

/// Each sample lies in its own cell of the unit interval or square. Computes where the sample point lies
/// within this cell, along one axis, as a fraction of the cell's width. The fraction is a multiple of 2^-24
/// in [0, 1). It is random, or 0.5 if the points are the cells' centres.
template <int lanes>
[[gnu::always_inline]] inline void shares(const StrataTask& t, std::uint32_t purpose, double* share) {
    const std::uint64_t key = t.key.stream(purpose);
    for (int i = 0; i < lanes; ++i) {
        const std::uint32_t bits = random_word(key, t.first + static_cast<std::uint32_t>(i)) >> 8;
        share[i] = t.where == CellPoint::centre ? 0.5 : static_cast<std::int32_t>(bits) * 0x1p-24;
    }
}

template <int lanes>
[[gnu::always_inline]] inline void points_2d(const StrataTask& t, float* u, float* v) {
    alignas(64) std::uint32_t cell[lanes];
    alignas(64) double share_u[lanes], share_v[lanes];
    cells<lanes>(t, cell);
    shares<lanes>(t, 1, share_u);
    shares<lanes>(t, 2, share_v);
    const Divisor n(t.n), rows(t.rows);
    const std::uint32_t few = t.n / t.rows;  // a row has this number of cells, or one more
    const Divisor few_cells(few), more_cells(few + 1);
    for (int i = 0; i < lanes; ++i) {
        const double c = static_cast<std::int32_t>(cell[i]);
        // Finds the row of cell c. The unit square is divided into `rows` rows and n cells, which are
        // numbered row by row, and row r begins at cell floor(r * n / rows). Cell c lies in the last row that
        // begins at c or before it. `begin` and `end` are the numbers of the first cells of this row and of
        // the next one.
        const std::int32_t row = n.rounded_down((c + 1) * rows.value - 1);
        const std::int32_t begin = rows.rounded_down(row * n.value),
                           end = rows.rounded_down((row + 1) * n.value);
        const bool is_few = end - begin == static_cast<std::int32_t>(few);
        const double column = c - begin;
        Divisor cells_of_row = more_cells;
        cells_of_row.value = is_few ? few_cells.value : more_cells.value;
        cells_of_row.inverse = is_few ? few_cells.inverse : more_cells.inverse;
        u[i] = unit_float_24(between(cells_of_row.edge(column), cells_of_row.edge(column + 1), share_u[i]));
        // All n cells of the unit square have the same area. So the height of a row is proportional to its
        // number of cells: a row with the cells `begin` to end - 1 extends from begin / n to end / n.
        v[i] = unit_float_24(between(n.edge(begin), n.edge(end), share_v[i]));
    }
}

template <int lanes>
[[gnu::always_inline]] inline void points_1d(const StrataTask& t, float* u) {
    alignas(64) std::uint32_t cell[lanes];
    alignas(64) double share[lanes];
    cells<lanes>(t, cell);
    shares<lanes>(t, 1, share);
    const Divisor n(t.n);
    for (int i = 0; i < lanes; ++i) {
        const double c = static_cast<std::int32_t>(cell[i]);
        u[i] = unit_float_24(between(n.edge(c), n.edge(c + 1), share[i]));
    }
}

POSTLENS_MULTIVERSION void strata_2d_16(const StrataTask& t, float* u, float* v) {
    points_2d<sample_lanes>(t, u, v);
}
POSTLENS_MULTIVERSION void strata_1d_16(const StrataTask& t, float* u) {
    points_1d<sample_lanes>(t, u);
}

}  // namespace

Strata::Strata(std::uint32_t n)
    : n_(n), rows_(static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n))))) {
    assert(n >= 1 && n <= 1U << 20);
}

void Strata::fill_2d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u,
                     float* v) const {
    const StrataTask task{key, where, permuted, n_, rows_, static_cast<std::uint32_t>(first)};
    if (lanes == 1)
        points_2d<1>(task, u, v);
    else
        strata_2d_16(task, u, v);
}

void Strata::fill_1d(SetKey key, CellPoint where, bool permuted, int first, int lanes, float* u) const {
    const StrataTask task{key, where, permuted, n_, rows_, static_cast<std::uint32_t>(first)};
    if (lanes == 1)
        points_1d<1>(task, u);
    else
        strata_1d_16(task, u);
}

}  // namespace postlens
