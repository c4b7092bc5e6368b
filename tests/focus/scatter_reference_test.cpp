// The fast form of the scatter method against slow reference forms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "focus/scatter/scatter.h"
#include "lens/ellipse_coverage.h"
#include "records/quadtree.h"
#include "tests/focus/focus_records.h"
#include "tests/support/random_records.h"

namespace postlens::test::scatter_reference_test {
namespace {

void expect_equals_reference(const SplatTables& tables) {
    Image fast;
    scatter(tables, fast);
    const Image slow = scatter_reference(tables);
    ASSERT_EQ(fast.rgb.size(), slow.rgb.size());
    for (std::size_t i = 0; i < fast.rgb.size(); ++i) {
        const double wanted = static_cast<double>(slow.rgb[i]);
        ASSERT_NEAR(static_cast<double>(fast.rgb[i]), wanted, 1e-6 * std::max(1.0, std::abs(wanted))) << i;
    }
}

TEST(Scatter, RunsEqualTheReference) {
    std::mt19937 random(17);
    std::uniform_real_distribution<float> colour(0, 2);
    for (const double radius : {1e-3, 0.6, 1.4, 4.0, 9.5, 33.0, 90.0, 400.0}) {
        // Runs of many lengths, some shorter than a strip.
        const RecordBand band = corner_band(170, 75, 3, [&](int x, int y) {
            const bool other = (x / 37 + y / 11) % 3 == 0;
            return std::vector{corner(other ? 1 / (radius * 0.8 + 0.3) : 1 / radius, colour(random),
                                      colour(random), colour(random))};
        });
        const auto tables = tables_of(band, 3);
        std::size_t runs = 0;
        for (int y = band.y_begin; y < band.y_end; ++y) runs += tables->row(y).runs.size();
        EXPECT_GT(runs, 0U);
        expect_equals_reference(*tables);
    }
    for (const double radius : {400.0, 3000.0}) {
        expect_equals_reference(*tables_of(
            corner_band(1300, 4, 0,
                        [&](int, int) { return std::vector{corner(1 / radius, colour(random), 0, 1)}; }),
            0));
    }
}

TEST(Scatter, SplatsEqualTheReference) {
    std::mt19937 random(23);
    const RandomOptions options{.levels = 5, .probability = 0.35, .has_w = true};
    for (const double scale : {1e-6, 0.3, 3.0, 40.0}) {
        const RecordBand band = random_band(random, -4, 33, -4, 25, options);
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px *= scale;
        geometry.inverse_focus_per_m = 0.3;
        // The depths that the models use differ, but not what is done with them.
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            if (model != DepthModel::ray_differentials && scale != 3) continue;
            expect_equals_reference(*tables_of(band, 4, {.geometry = geometry, .model = model}));
        }
    }
}

/// Scatters each point sample with its exact CoC and position, without tables. Where leaves of different
/// sizes meet, each moves its part of a sample by a sixth of its edge towards its centre.
Image exact_scatter(const RecordBand& band, const FocusGeometry& geometry) {
    PointSamples samples;
    find_point_samples(band, band.y_begin, band.y_end, band.y_begin, band.y_end - 1, samples);
    Image image(band.width() - 1, band.height() - 1);
    std::vector<double> sums(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                             4);
    for (const PointSample& s : samples.samples) {
        const Record& r = band.records[s.first_record];
        const double radius = std::abs(geometry.coc_diameter_px(1 / static_cast<double>(r.z))) / 2;
        const double weight = static_cast<double>(s.total_weight());
        glm::dvec2 place(static_cast<double>(s.x) - band.x_begin, static_cast<double>(s.y) - band.y_begin);
        for (std::size_t q = 0; q < 4 && weight > 0; ++q) {
            const glm::dvec2 inwards(q % 2 == 0 ? -1 : 1, q / 2 == 0 ? -1 : 1);
            place +=
                static_cast<double>(s.weight[q]) / weight * static_cast<double>(s.leaf_size[q]) / 6 * inwards;
        }
        const auto rows = ellipse_coverage(Ellipse::disc(std::max(radius, 1e-4)), place.x, place.y);
        for (const CoverageRow& row : rows) {
            if (row.y < 0 || row.y >= image.height) continue;
            for (std::size_t i = 0; i < row.share.size(); ++i) {
                const int x = row.x_begin + static_cast<int>(i);
                if (x < 0 || x >= image.width) continue;
                double* sum = sums.data() +
                              4 * (static_cast<std::size_t>(row.y) * static_cast<std::size_t>(image.width) +
                                   static_cast<std::size_t>(x));
                const double h = weight * row.share[i];
                sum[0] += h * static_cast<double>(r.r);
                sum[1] += h * static_cast<double>(r.g);
                sum[2] += h * static_cast<double>(r.b);
                sum[3] += h;
            }
        }
    }
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        image.rgb[i] = static_cast<float>(sums[i / 3 * 4 + i % 3] / sums[i / 3 * 4 + 3]);
    }
    return image;
}

TEST(Scatter, SubdividedPicturesEqualEachSampleAtItsOwnPlace) {
    std::mt19937 random(29);
    for (const double radius : {2.5, 6.0, 12.5}) {
        // All leaves are 1/4 px wide, so kernels exist for the positions of all samples except those on the
        // raster's border, which have leaves on one side only.
        RecordBand band = random_band(random, 0, 50, 0, 40, {.levels = 2, .probability = 1});
        for (Record& r : band.records) r.z = static_cast<float>(1 / radius);
        const Image got = scattered(band, 0, {.depths = 2}), exact = exact_scatter(band, unit_geometry);
        const int border = static_cast<int>(radius) + 2;
        for (int y = border; y < got.height - border; ++y) {
            for (int x = border; x < got.width - border; ++x)
                ASSERT_NEAR(got.pixel(x, y)[1], exact.pixel(x, y)[1], 4e-6) << radius;
        }
    }
}

/// Moments of a border's blur, px and px^2.
struct BorderBlur {
    double place = 0, variance = 0;
};

/// Blur of a border between two colours at `edge_px`, by discs of `radius_px`. One column of pixels is
/// divided into 16 x 16 cells, the others are not.
BorderBlur border_blur(double edge_px, double radius_px) {
    constexpr int width = 80, height = 40, parts = 16;
    const int divided = static_cast<int>(edge_px);
    RecordBand band;
    band.x_end = width + 1;
    band.y_end = height + 1;
    for (int y = 0; y <= height; ++y) {
        for (int x = 0; x <= width; ++x) {
            // The right border of a pixel belongs to its neighbour, the lower border to the next row.
            const int rows = (x == divided || x == divided + 1) && y < height ? parts : 1;
            const int columns = x == divided ? parts : 1;
            for (int j = 0; j < rows; ++j) {
                for (int i = 0; i < columns; ++i) {
                    const double at = x + i / static_cast<double>(parts);
                    Record r = corner(1 / radius_px, at < edge_px ? 1.0F : 0.0F, 0, 0);
                    r.x = static_cast<float>(at);
                    r.y = static_cast<float>(y + j / static_cast<double>(parts));
                    band.records.push_back(r);
                }
            }
            band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
        }
    }
    const Image image = scattered(band, 0, {.depths = 2});
    double mean = 0, square = 0;
    for (int x = 20; x < 60; ++x) {
        const double share = static_cast<double>(image.pixel(x - 1, height / 2)[0]) -
                             static_cast<double>(image.pixel(x, height / 2)[0]);
        mean += share * x;
        square += share * x * x;
    }
    return {mean, square - mean * mean};
}

// A disc has the variance r^2 / 4 along an axis. Differences between pixels add that of a triangle, 1 / 6;
// the trapezoidal rule would add another 1 / 6.
TEST(Scatter, BordersThatLeavesAreDividedForAreNoWiderThanTheirDisc) {
    for (const double radius : {3.3, 6.2, 12.7}) {
        for (const double edge : {40.22, 40.47, 40.78}) {
            const BorderBlur got = border_blur(edge, radius);
            // Samples are 1/16 px apart.
            EXPECT_NEAR(got.place, edge, 1.0 / 32 + 0.01) << radius;
            EXPECT_NEAR(got.variance - radius * radius / 4 - 1.0 / 6, 0, 0.025) << radius << ", " << edge;
        }
    }
}

TEST(Scatter, FinePositionsAreSharedOutToNeighbouringPhases) {
    std::mt19937 random(31);
    // The discs of 2.5 and 20 px end within the image. Those of 300 px cover an image of any size that is
    // quick to compute, so a few pixels show what a larger image would: that no weight is lost.
    for (const auto& [radius, size_px] : {std::pair{2.5, 12}, {20.0, 30}, {300.0, 3}}) {
        RecordBand band = random_band(random, 0, size_px, 0, size_px, {.levels = 5, .probability = 0.35});
        for (Record& r : band.records) r.z = static_cast<float>(1 / radius);
        // The error of an edge is at most (step / radius)^2 / 8, for colours of up to 4.
        EXPECT_LT(difference(scattered(band, 0, {.depths = 2}), exact_scatter(band, unit_geometry)), 1e-3)
            << radius;
    }
}

double psnr_db(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double d = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
        sum += d * d;
    }
    return -10 * std::log10(sum / static_cast<double>(a.rgb.size()));
}

/// Tiles at random depths from 0.6 to 40 m, uniform in inverse depth.
RecordBand tiles(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> inverse_depth(1 / 40.0, 1 / 0.6),
        logarithm(std::log(0.6), std::log(40.0));
    std::vector<double> depth_m;
    for (int i = 0; i < 400; ++i)
        depth_m.push_back(i % 2 == 0 ? 1 / inverse_depth(random) : std::exp(logarithm(random)));
    std::uniform_real_distribution<float> colour(0, 1);
    std::vector<float> shade;
    for (int i = 0; i < 400; ++i) shade.push_back(colour(random));
    return corner_band(120, 90, 0, [&](int x, int y) {
        const std::size_t tile = static_cast<std::size_t>(x / 9 + 17 * (y / 9)) % 400;
        // Each tile has a checker with its own brightness.
        const float v = shade[tile] * ((x / 3 + y / 3) % 2 == 0 ? 1.0F : 0.3F);
        return std::vector{corner(depth_m[tile], v, shade[(tile + 100) % 400], 1 - v)};
    });
}

TEST(DepthSpacing, InverseStepsAreTheBetterChoiceAtEqualCost) {
    FocusGeometry geometry = lens_geometry;
    geometry.inverse_focus_per_m = 1 / 3.0;
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        const RecordBand band = tiles(seed);
        const Image exact = exact_scatter(band, geometry);
        const auto error_db = [&](DepthSpacing spacing, std::optional<int> depths) {
            return psnr_db(scattered(band, 0, {.geometry = geometry, .spacing = spacing, .depths = depths}),
                           exact);
        };
        for (const int k : {8, 16, 32, 64}) {
            EXPECT_GT(error_db(DepthSpacing::inverse, k), error_db(DepthSpacing::linear, k) + 5)
                << seed << " " << k;
        }
        // The quantisation of the default has a negligible error.
        EXPECT_GT(error_db(DepthSpacing::inverse, std::nullopt), 58) << seed;
    }
}

}  // namespace
}  // namespace postlens::test::scatter_reference_test
