// Renders of one scene with many seeds: the mean of a figure and its standard error.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <vector>

#include "tracer/render.h"

namespace postlens::test {

/// The number of renders, with seeds 0 to repeats - 1.
inline constexpr int repeats = 32;

/// The mean of a figure over the renders.
struct Estimate {
    double mean = 0, standard_error = 0;
};

/// Estimates of the figures of an image. Renders with different seeds are independent.
inline std::vector<Estimate> repeated(const Scene& scene, RenderSettings settings,
                                      const std::function<std::vector<double>(const Image&)>& figures) {
    std::vector<double> sum, squares;
    for (int seed = 0; seed < repeats; ++seed) {
        settings.seed = static_cast<std::uint64_t>(seed);
        const std::vector<double> values = figures(render_picture(scene, settings).image);
        sum.resize(values.size());
        squares.resize(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            sum[i] += values[i];
            squares[i] += values[i] * values[i];
        }
    }
    std::vector<Estimate> out;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        const double mean = sum[i] / repeats;
        const double variance = std::max(0.0, squares[i] / repeats - mean * mean) * repeats / (repeats - 1);
        out.push_back({mean, std::sqrt(variance / repeats)});
    }
    return out;
}

/// The mean of the red channel in each column.
inline std::vector<double> column_means(const Image& image) {
    std::vector<double> out(static_cast<std::size_t>(image.width), 0);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x)
            out[static_cast<std::size_t>(x)] += static_cast<double>(image.pixel(x, y)[0]) / image.height;
    }
    return out;
}

/// The red channel of all pixels.
inline std::vector<double> pixels(const Image& image) {
    std::vector<double> out;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) out.push_back(static_cast<double>(image.rgb[i]));
    return out;
}

/// Expects each figure within 4 standard errors, plus `rounding`, of its expected value. The standard error
/// of 32 values is itself uncertain: by Student's distribution, one figure in 2700 is outside by chance. One
/// in 1000 figures, and one more, may therefore be outside, but within 6 standard errors (one in 800 000).
inline void expect_figures(const std::vector<Estimate>& got, const std::vector<double>& expected,
                           double rounding, const char* what) {
    ASSERT_EQ(got.size(), expected.size());
    std::size_t out = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        const double error = std::abs(got[i].mean - expected[i]);
        EXPECT_LE(error, 6 * got[i].standard_error + rounding)
            << what << ", figure " << i << ": " << got[i].mean << " +- " << got[i].standard_error
            << ", expected " << expected[i];
        out += error > 4 * got[i].standard_error + rounding ? 1U : 0U;
    }
    EXPECT_LE(out, 1 + got.size() / 1000) << what;
}

/// The mean of f over [a, b] by the midpoint rule with n intervals.
template <typename F>
double mean_over(double a, double b, const F& f, int n = 4000) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += f(a + (b - a) * (i + 0.5) / n);
    return sum / n;
}

}  // namespace postlens::test
