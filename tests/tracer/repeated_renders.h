// Renders of one scene by many seeds: their mean, and how sure it is.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <vector>

#include "tracer/render.h"

namespace postlens::test {

inline constexpr int repeats = 32;

struct Estimate {
    double mean = 0, standard_error = 0;
};

/// Several figures of a picture, over the seeds 0 .. repeats - 1: a render with another seed is independent.
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

/// The red channel's mean over the rows of every column.
inline std::vector<double> column_means(const Image& image) {
    std::vector<double> out(static_cast<std::size_t>(image.width), 0);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x)
            out[static_cast<std::size_t>(x)] += static_cast<double>(image.pixel(x, y)[0]) / image.height;
    }
    return out;
}

/// Red channel, pixel by pixel.
inline std::vector<double> pixels(const Image& image) {
    std::vector<double> out;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) out.push_back(static_cast<double>(image.rgb[i]));
    return out;
}

/// Every figure within 4 standard errors of what is expected, and `rounding`. A standard error that 32 values
/// gave is itself uncertain: by Student's distribution one figure in 2700 lies further out by chance, so of
/// some hundred in a test one may, up to 6 (one in 800 000).
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

/// The mean of f over [a, b] by the middles of n pieces.
template <typename F>
double mean_over(double a, double b, const F& f, int n = 4000) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += f(a + (b - a) * (i + 0.5) / n);
    return sum / n;
}

}  // namespace postlens::test
