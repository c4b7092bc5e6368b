#include "tracer/strata.h"

#include <cassert>
#include <cmath>

#include "core/multiversion.h"
#include "tracer/permutation.h"

namespace postlens {
namespace {

struct StrataTask {
    SetKey key;
    CellPoint where;
    bool permuted;
    std::uint32_t n, rows, first;
};

// Quotients of integers below 2^31 by integers below 2^21 are exact at their floor and ceiling in double: a
// quotient that is no integer is 2^-20 or more away from one, its rounding error below 2^-22.
[[gnu::always_inline]] inline std::int32_t floor_divided(double a, double b) {
    return static_cast<std::int32_t>(a / b);
}

/// A multiple of 2^-24 in the interval `cell` of `count` equal ones, as 24 bits.
[[gnu::always_inline]] inline std::int32_t inside(double cell, double count, double share) {
    const double low = cell * 0x1p24 / count, high = (cell + 1) * 0x1p24 / count;
    auto begin = static_cast<std::int32_t>(low), end = static_cast<std::int32_t>(high);
    begin += static_cast<double>(begin) < low ? 1 : 0;
    end += static_cast<double>(end) < high ? 1 : 0;
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

/// Where in its cell a point lies, in [0, 1), of 24 bits.
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
    const double n = t.n, rows = t.rows;
    for (int i = 0; i < lanes; ++i) {
        const double c = static_cast<std::int32_t>(cell[i]);
        // The last row that begins at or before cell c: row_begin(row) <= c means row * n < (c + 1) * rows.
        const std::int32_t row = floor_divided((c + 1) * rows - 1, n);
        const std::int32_t begin = floor_divided(row * n, rows), end = floor_divided((row + 1) * n, rows);
        u[i] = unit_float_24(inside(c - begin, end - begin, share_u[i]));
        // The row's height is its share of the cells.
        const double low = begin * 0x1p24 / n, high = end * 0x1p24 / n;
        auto bottom = static_cast<std::int32_t>(low), top = static_cast<std::int32_t>(high);
        bottom += static_cast<double>(bottom) < low ? 1 : 0;
        top += static_cast<double>(top) < high ? 1 : 0;
        v[i] = unit_float_24(bottom + static_cast<std::int32_t>(share_v[i] * (top - bottom)));
    }
}

template <int lanes>
[[gnu::always_inline]] inline void points_1d(const StrataTask& t, float* u) {
    alignas(64) std::uint32_t cell[lanes];
    alignas(64) double share[lanes];
    cells<lanes>(t, cell);
    shares<lanes>(t, 1, share);
    for (int i = 0; i < lanes; ++i)
        u[i] = unit_float_24(inside(static_cast<std::int32_t>(cell[i]), t.n, share[i]));
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
