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
    /// Returns where interval number `cell` begins if [0, 1) is divided into `value` equal intervals. The
    /// result is in units of 2^-24, rounded up. `cell` is an integer from 0 on.
    [[nodiscard, gnu::always_inline]] std::int32_t edge(double cell) const {
        // Computes a / d, rounded up, where a = cell * 2^24 and d = `value` are integers. This is floor((a +
        // d - 1) / d). Because the product with `inverse` (1 / d) replaces the division, it may be slightly
        // too small. So 0.5 is added to the numerator. This cannot change the exact result: (a + d - 1) / d
        // is a multiple of 1 / d, and 0.5 / d is less than the distance to the next one.
        return static_cast<std::int32_t>((cell * 0x1p24 + (value - 0.5)) * inverse);
    }
};

/// Divides the interval [begin, end) in a given ratio: returns begin + share * (end - begin), rounded down.
/// `share` is at least 0 and less than 1.
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

/// Computes one coordinate of each sample's point inside the sample's own cell. The cells divide the unit
/// interval or the unit square. The coordinate is a fraction of the cell's width, a multiple of 2^-24 in [0,
/// 1). It is 0.5 if the point is the cell's centre, and random otherwise. Different values of `purpose` give
/// independent coordinates.
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
        // Finds the row of cell c. The unit square is divided into `rows` rows of cells. The n cells are
        // numbered row by row, and row r begins with the cell floor(r * n / rows). So the row of cell c is
        // the greatest r for which r * n / rows < c + 1. `begin` is the first cell of this row, and `end` is
        // the first cell of the next row.
        const std::int32_t row = n.rounded_down((c + 1) * rows.value - 1);
        const std::int32_t begin = rows.rounded_down(row * n.value),
                           end = rows.rounded_down((row + 1) * n.value);
        const bool is_few = end - begin == static_cast<std::int32_t>(few);
        const double column = c - begin;
        Divisor cells_of_row = more_cells;
        cells_of_row.value = is_few ? few_cells.value : more_cells.value;
        cells_of_row.inverse = is_few ? few_cells.inverse : more_cells.inverse;
        u[i] = unit_float_24(between(cells_of_row.edge(column), cells_of_row.edge(column + 1), share_u[i]));
        // Computes the coordinate v of the sample point, which lies in this row. The n cells of the unit
        // square have equal areas, so the height of a row is proportional to its number of cells. The row
        // with the cells `begin` to end - 1 therefore extends from v = begin / n to v = end / n.
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
