// The convolution i1 * i2: a moving bar, both methods against the definition, and conservation of light.
#include "motionblur/convolution/convolution.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "core/threads.h"
#include "motionblur/convolution/fft_convolution.h"
#include "tests/motionblur/drawn_path.h"

namespace postlens::test::convolution_test {
namespace {

using glm::dvec2;

std::vector<PathPoint> straight(dvec2 way_px) {
    return {{0, {0, 0}}, {1, way_px}};
}

Planes zeros(int x_begin, int y_begin, int width, int height, std::size_t planes) {
    return {x_begin, y_begin, width, height,
            std::vector(planes, std::vector<float>(static_cast<std::size_t>(width * height)))};
}

float value(const Planes& p, std::size_t plane, int x, int y) {
    if (x < p.x_begin || y < p.y_begin || x >= p.x_begin + p.width || y >= p.y_begin + p.height) return 0;
    return p.planes[plane][static_cast<std::size_t>((y - p.y_begin) * p.width + x - p.x_begin)];
}

double largest(const std::vector<float>& values) {
    double out = 0;
    for (const float v : values) out = std::max(out, std::abs(static_cast<double>(v)));
    return out;
}

double sum(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

void expect_equal(const Planes& a, const Planes& b, double part, const std::string& what) {
    ASSERT_EQ(a.x_begin, b.x_begin) << what;
    ASSERT_EQ(a.y_begin, b.y_begin) << what;
    ASSERT_EQ(a.width, b.width) << what;
    ASSERT_EQ(a.height, b.height) << what;
    ASSERT_EQ(a.planes.size(), b.planes.size()) << what;
    for (std::size_t p = 0; p < a.planes.size(); ++p) {
        const double tolerance = part * largest(b.planes[p]);
        double worst = 0;
        for (std::size_t i = 0; i < a.planes[p].size(); ++i)
            worst = std::max(
                worst, std::abs(static_cast<double>(a.planes[p][i]) - static_cast<double>(b.planes[p][i])));
        EXPECT_LE(worst, tolerance) << what << ", plane " << p;
    }
}

// A disc of noise with some pixels of radiance 50 and some empty rows and columns. The last plane also has
// negative values.
Planes random_planes(std::mt19937& random, int width, int height, std::size_t planes) {
    std::uniform_real_distribution<float> uniform(0, 1);
    std::uniform_int_distribution<int> place(-30, 30);
    Planes out = zeros(place(random), place(random), width, height, planes);
    for (std::size_t p = 0; p < planes; ++p) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double dx = (x + 0.5) / width - 0.5, dy = (y + 0.5) / height - 0.5;
                if (dx * dx + dy * dy > 0.2) continue;
                float v = uniform(random);
                if (v > 0.99F) v = 50;
                if (p == 3) v -= 0.5F;
                out.planes[p][static_cast<std::size_t>(y * width + x)] = v;
            }
        }
    }
    return out;
}

TEST(Convolution, AMovingBarIsATrapezoid) {
    // A bar of w px on [0, w) moves by d px. Position x gets light while the displacement r satisfies
    // x - w < r <= x.
    for (const int cells : {1, 2, 4}) {
        for (const int w : {3, 8, 12}) {
            for (const int d : {-12, 5, 8, 20}) {
                Planes bar = zeros(0, 0, w * cells, cells, 1);
                std::fill(bar.planes[0].begin(), bar.planes[0].end(), 1.0F);
                for (const auto method : {ConvolutionMethod::direct, ConvolutionMethod::fft}) {
                    const Planes blurred = convolve(bar, draw(straight({d, 0}), cells), method);
                    const auto covered = [&](double x) {
                        const double low = std::min(d, 0), high = std::max(d, 0);
                        return std::max(0.0, std::min(x, high) - std::max(x - w, low)) / std::abs(d);
                    };
                    double highest = 0;
                    for (int x = -15 * cells; x < 35 * cells; ++x) {
                        // The result is exact at the centres of cells; a cell at the end of the path has
                        // weight 1/2.
                        const double expected = covered((x + 0.5) / cells);
                        EXPECT_NEAR(value(blurred, 0, x, 0), expected, 2e-6) << cells << " " << w << " " << d;
                        highest = std::max(highest, static_cast<double>(value(blurred, 0, x, 0)));
                    }
                    // Without a plateau, the peak lies half a cell from the nearest centre.
                    const double top = std::min(1.0, 1.0 * w / std::abs(d));
                    EXPECT_NEAR(highest, top, w == std::abs(d) ? 0.5 / (cells * w) + 2e-6 : 2e-6);
                }
            }
        }
    }
}

TEST(Convolution, ATriangularShutterIsTheDifferenceOfItsLight) {
    const int w = 6, d = 10;
    Planes bar = zeros(4, 1, 2, w, 1);
    std::fill(bar.planes[0].begin(), bar.planes[0].end(), 1.0F);
    const Planes blurred = convolve(bar, draw(straight({0, d}), 1, ShutterCurve::triangle()));
    const ShutterCurve curve = ShutterCurve::triangle();
    for (int y = 0; y < 20; ++y) {
        const double at = y + 0.5 - 1;
        const double expected = curve.light(at / d) - curve.light((at - w) / d);
        EXPECT_NEAR(value(blurred, 0, 5, y), expected, 2e-6) << y;
    }
}

TEST(Convolution, BothWaysAreTheDefinition) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-25, 25);
    for (int run = 0; run < 24; ++run) {
        const Planes i1 = random_planes(random, 5 + 13 * (run % 7), 70 - 11 * (run % 6), 1 + run % 4);
        std::vector<PathPoint> points;
        const int count = 2 + run % 4;
        for (int i = 0; i < count; ++i) points.push_back({1.0 * i, {place(random), place(random)}});
        if (run % 6 == 1) points[1].at_px.y = points[0].at_px.y;  // along a row, which gives runs of cells
        if (run % 6 == 2) points[1].at_px.x = points[0].at_px.x;  // along a column: runs after transposition
        if (run % 6 == 3) points.assign(2, {0, {3, 4}}), points[1].time_s = 1;
        const PathRaster i2 =
            draw(points, 1 + run % 2, run % 3 == 0 ? ShutterCurve::triangle() : ShutterCurve::box());
        const Planes reference = convolve_reference(i1, i2);
        ConvolutionMethod used = ConvolutionMethod::automatic;
        // Tolerance: float sums of 32 terms, and the rounding of the result.
        expect_equal(convolve(i1, i2, ConvolutionMethod::direct, &used), reference, 35 * 0x1p-24,
                     fmt::format("direct {}", run));
        EXPECT_EQ(used, ConvolutionMethod::direct);
        expect_equal(convolve(i1, i2, ConvolutionMethod::fft, &used), reference, 5e-6,
                     fmt::format("fft {}", run));
        EXPECT_EQ(used, ConvolutionMethod::fft);
        expect_equal(convolve(i1, i2), reference, 5e-6, fmt::format("automatic {}", run));
    }
}

TEST(Convolution, LightsOfRadiance50KeepBothWaysTogether) {
    // The image is large enough for block-wise transforms, and the path is closed.
    std::mt19937 random(8);
    const Planes i1 = random_planes(random, 600, 400, 2);
    const PathRaster i2 = draw({{0, {0, 0}}, {1, {60, 25}}, {2, {31, -40}}, {3, {0, 0}}}, 2);
    const Planes direct = convolve(i1, i2, ConvolutionMethod::direct);
    const Planes fft = convolve(i1, i2, ConvolutionMethod::fft);
    expect_equal(fft, direct, 1e-5, "fft against direct");
    for (std::size_t p = 0; p < 2; ++p) {
        // Each value has a relative rounding error of 2^-24, and sums at most 34 times that.
        EXPECT_NEAR(sum(direct.planes[p]) / sum(i1.planes[p]), 1, 35 * 0x1p-24);
        EXPECT_GE(*std::min_element(fft.planes[p].begin(), fft.planes[p].end()), 0);
    }
}

TEST(Convolution, LongPathsGoInBlocksAndStayExact) {
    // Block-wise transforms pay for a small image on a long path and for a large image on a short path.
    std::mt19937 random(9);
    for (const auto& [size, way] : {std::pair(20, dvec2(900, 130)), std::pair(900, dvec2(9, 7))}) {
        const Planes i1 = random_planes(random, size, size / 2, 1);
        const PathRaster i2 = draw(straight(way), 1);
        expect_equal(convolve(i1, i2, ConvolutionMethod::fft), convolve(i1, i2, ConvolutionMethod::direct),
                     1e-5, fmt::format("size {}", size));
    }
}

TEST(Convolution, AWantedWindowIsThatPartOfTheWhole) {
    std::mt19937 random(10);
    for (int run = 0; run < 12; ++run) {
        const Planes i1 = random_planes(random, 90, 60, 2);
        const PathRaster i2 = draw(straight({run % 2 == 0 ? 50.0 : 3.0, run % 3 == 0 ? 0.0 : -37.5}), 1);
        const Planes all = convolve_reference(i1, i2);
        const CellWindow wanted{i1.x_begin - 20 + 5 * run, i1.x_begin + 40 + 2 * run, i1.y_begin - 30,
                                i1.y_begin + 5 + 9 * run};
        for (const auto method : {ConvolutionMethod::direct, ConvolutionMethod::fft}) {
            const Planes part = convolve(i1, i2, method, nullptr, wanted);
            EXPECT_EQ(part.x_begin, std::max(all.x_begin, wanted.x_begin));
            EXPECT_EQ(part.x_begin + part.width, std::min(all.x_begin + all.width, wanted.x_end));
            for (std::size_t p = 0; p < 2; ++p) {
                for (int y = part.y_begin; y < part.y_begin + part.height; ++y)
                    for (int x = part.x_begin; x < part.x_begin + part.width; ++x)
                        ASSERT_NEAR(value(part, p, x, y), value(all, p, x, y), 5e-6 * 50) << run;
            }
        }
        const Planes none =
            convolve(i1, i2, ConvolutionMethod::automatic, nullptr, CellWindow{5000, 5010, 0, 9});
        EXPECT_EQ(none.width * none.height, 0);
        EXPECT_EQ(none.planes.size(), 2U);
    }
}

TEST(Convolution, NothingConvolvedIsNothing) {
    const PathRaster path = draw(straight({30, 10}));
    for (const auto method :
         {ConvolutionMethod::automatic, ConvolutionMethod::direct, ConvolutionMethod::fft}) {
        const Planes black = convolve(zeros(3, 4, 10, 10, 3), path, method);
        EXPECT_EQ(black.width, 10 + path.width - 1);
        for (const auto& plane : black.planes) EXPECT_EQ(largest(plane), 0);
        EXPECT_TRUE(convolve(Planes{}, path, method).planes.empty());
        EXPECT_EQ(convolve(zeros(0, 0, 4, 4, 2), PathRaster{}, method).width, 0);
        // A constant displacement only shifts the image.
        Planes point = zeros(3, 4, 5, 5, 1);
        point.planes[0][12] = 50;
        const Planes moved = convolve(point, draw({{0, {2, -1}}}), method);
        EXPECT_NEAR(value(moved, 0, 7, 5), 50, 1e-5);
        EXPECT_EQ(std::count(moved.planes[0].begin(), moved.planes[0].end(), 0.0F), 24);
    }
}

TEST(Convolution, SameBitsForAnyNumberOfThreads) {
    std::mt19937 random(11);
    const Planes i1 = random_planes(random, 150, 130, 4);
    for (const auto& way : {dvec2(70, 3), dvec2(2, 90), dvec2(40, 41)}) {
        const PathRaster i2 = draw(straight(way), 2);
        for (const auto method :
             {ConvolutionMethod::automatic, ConvolutionMethod::direct, ConvolutionMethod::fft}) {
            std::vector<Planes> results;
            for (const int threads : {1, 5}) {
                const ThreadLimit limit(threads);
                results.push_back(convolve(i1, i2, method));
            }
            EXPECT_EQ(results[0].planes, results[1].planes);
        }
    }
}

TEST(Convolution, TheCheaperWayIsTaken) {
    std::mt19937 random(12);
    const Planes i1 = random_planes(random, 300, 300, 1);
    ConvolutionMethod used{};
    // Few cells, or runs of cells, are summed directly. Thousands of scattered cells are convolved by FFT.
    for (const auto& way : {dvec2(4, 3), dvec2(200, 0), dvec2(0, 200)}) {
        (void)convolve(i1, draw(straight(way)), ConvolutionMethod::automatic, &used);
        EXPECT_EQ(used, ConvolutionMethod::direct);
    }
    std::vector<PathPoint> scribble;
    std::uniform_real_distribution<double> place(-60, 60);
    for (int i = 0; i < 200; ++i) scribble.push_back({1.0 * i, {place(random), place(random)}});
    (void)convolve(i1, draw(scribble), ConvolutionMethod::automatic, &used);
    EXPECT_EQ(used, ConvolutionMethod::fft);
    const ConvolutionCosts costs = predict_costs(i1, draw(scribble));
    EXPECT_GT(costs.direct_s, costs.fft_s);
}

TEST(FastFftSize, IsTheNextProductOfSmallPrimes) {
    for (const auto& [n, size] : {std::pair(1, 1), std::pair(2, 2), std::pair(11, 12), std::pair(13, 14),
                                  std::pair(121, 125), std::pair(541, 560), std::pair(1081, 1120)}) {
        EXPECT_EQ(fast_fft_size(n), size);
        EXPECT_EQ(fast_fft_size(size), size);
    }
}

}  // namespace
}  // namespace postlens::test::convolution_test
