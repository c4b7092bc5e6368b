// Statistics of point sets: moments, correlation and chi-square.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include "tracer/sampling/sampler.h"

namespace postlens::test {

/// All kinds of samplers.
inline constexpr std::array all_kinds{SamplerKind::grid, SamplerKind::jittered, SamplerKind::random,
                                      SamplerKind::poisson, SamplerKind::sobol};

inline std::string name_of(SamplerKind kind) {
    constexpr std::array names{"grid", "jittered", "random", "poisson", "sobol"};
    return names[static_cast<std::size_t>(kind)];
}

inline double mean(const std::vector<double>& x) {
    return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

inline double covariance(const std::vector<double>& x, const std::vector<double>& y) {
    const double mx = mean(x), my = mean(y);
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - mx) * (y[i] - my);
    return sum / static_cast<double>(x.size());
}

inline double variance(const std::vector<double>& x) {
    return covariance(x, x);
}

inline double correlation(const std::vector<double>& x, const std::vector<double>& y) {
    return covariance(x, y) / std::sqrt(variance(x) * variance(y));
}

/// The chi-square statistic of counts whose expectations are equal.
inline double chi_square(const std::vector<int>& counts) {
    const double expected =
        std::accumulate(counts.begin(), counts.end(), 0.0) / static_cast<double>(counts.size());
    double sum = 0;
    for (const int c : counts) sum += (c - expected) * (c - expected) / expected;
    return sum;
}

/// The index of the interval that contains x, of `cells` equal intervals of [0, 1).
inline std::size_t cell_of(double x, std::size_t cells) {
    return static_cast<std::size_t>(x * static_cast<double>(cells));
}

/// One factor of a smooth function of several dimensions. The integral over [0, 1) is 1.
inline double smooth(double x) {
    return 1 + 0.8 * (x - 0.5);
}

}  // namespace postlens::test
