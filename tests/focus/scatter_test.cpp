// The scatter method on records in memory: closed forms, mirrors and limits.
#include "focus/scatter/scatter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/job.h"
#include "records/quadtree.h"
#include "tests/focus/focus_records.h"
#include "tests/support/edge_response.h"
#include "tests/support/random_records.h"

namespace postlens::test::scatter_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Scatter, EdgeIsTheClosedForm) {
    // Discs at integer coordinates from x0 on add up to the edge response at the right side of each pixel,
    // because the columns of a disc are integrals of its profile.
    for (const double radius : {0.8, 3.3, 7.5, 21.0, 40.5}) {
        constexpr int x0 = 60;
        TableOptions options{.depths = 2};
        const auto across =
            scattered(corner_band(120, 20, 60,
                                  [&](int x, int) {
                                      const float v = x >= x0 ? 1.0F : 0.0F;
                                      return std::vector{corner(1 / radius, v, 0.5F * v, 1 - v)};
                                  }),
                      60, options);
        const auto down = scattered(
            corner_band(
                20, 120, 60,
                [&](int, int y) { return std::vector{corner(1 / radius, y >= x0 ? 1.0F : 0.0F, 0, 0)}; }),
            60, options);
        for (int i = 0; i < 120; ++i) {
            // z' is a float, so the radius has float rounding.
            const double wanted = edge_response((i + 1 - x0) / radius);
            EXPECT_NEAR(value(across, i, 10, 0), wanted, 1e-6) << radius << " " << i;
            EXPECT_NEAR(value(across, i, 10, 1), wanted / 2, 1e-6);
            EXPECT_NEAR(value(across, i, 10, 2), 1 - wanted, 1e-6);
            EXPECT_NEAR(value(down, 10, i, 0), wanted, 1e-6);
        }
    }
}

struct Point {
    double energy = 0, x = 0, y = 0;
};

Point point_of(const Image& image) {
    Point p;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double v = value(image, x, y, 0);
            p.energy += v;
            p.x += v * (x + 0.5);
            p.y += v * (y + 0.5);
        }
    }
    p.x /= p.energy;
    p.y /= p.energy;
    return p;
}

TEST(Scatter, PointKeepsEnergyAndCentroid) {
    for (const double radius : {0.05, 0.7, 1.9, 2.3, 6.0, 13.7, 25.0}) {
        const auto image = scattered(
            corner_band(64, 64, 30,
                        [&](int x, int y) {
                            return std::vector{corner(1 / radius, x == 31 && y == 33 ? 5e4F : 0.0F, 0, 0)};
                        }),
            30, {.depths = 2});
        const Point p = point_of(image);
        EXPECT_NEAR(p.energy, 5e4, 5e4 * 1e-6) << radius;
        EXPECT_NEAR(p.x, 31, 0.01) << radius;
        EXPECT_NEAR(p.y, 33, 0.01) << radius;
    }
}

TEST(Scatter, PointInsideAPixelKeepsItsCentroid) {
    for (const double radius : {0.05, 1.5, 2.5, 6.0, 20.0}) {
        RecordBand band =
            corner_band(64, 64, 30, [&](int, int) { return std::vector{corner(1 / radius, 0, 0, 0)}; });
        subdivide_pixel(band, 30, 32, [&](float x, float y) {
            return corner(1 / radius, x == 30.5F && y == 32.5F ? 8.0F : 0.0F, 0, 0);
        });
        const Point p = point_of(scattered(band, 30, {.depths = 2}));
        // The point has a quarter of each of four leaves.
        EXPECT_NEAR(p.energy, 2, 0.01) << radius;
        EXPECT_NEAR(p.x, 30.5, 0.01) << radius;
        EXPECT_NEAR(p.y, 32.5, 0.01) << radius;
    }
}

TEST(Scatter, BrightLightLeavesNoTraceWhereItDoesNotReach) {
    constexpr double radius = 11;
    const auto with_light = [&](float light) {
        return scattered(
            corner_band(200, 60, 0,
                        [&](int x, int y) {
                            return std::vector{corner(1 / radius, x == 40 && y == 30 ? light : 0.01F, 0, 0)};
                        }),
            0);
    };
    const Image dark = with_light(0.01F), bright = with_light(1e9F);
    for (int x = 60; x < 200; ++x)
        EXPECT_NEAR(value(bright, x, 30, 0), value(dark, x, 30, 0), 1e-6 * 0.01) << x;
    EXPECT_GT(value(bright, 45, 30, 0), 1e6);
}

TEST(Scatter, UniformStaysUniform) {
    std::mt19937 random(11);
    for (const double largest_radius : {0.5, 5.0, 60.0, 2000.0}) {
        std::uniform_real_distribution<double> radius(0, largest_radius);
        const auto image = scattered(
            corner_band(150, 90, 0,
                        [&](int x, int y) {
                            // Random radii on the left, runs of equal radii on the right.
                            const double r = x < 50 ? radius(random) : largest_radius * (y % 3 + 1) / 3;
                            return std::vector{corner(1 / r, 0.7F, 0.1F, 123.0F)};
                        }),
            0);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                ASSERT_NEAR(value(image, x, y, 0), 0.7F, 1e-6) << largest_radius << " " << x << " " << y;
                ASSERT_NEAR(value(image, x, y, 1), 0.1F, 1e-6);
                ASSERT_NEAR(value(image, x, y, 2), 123.0F, 123e-6);
            }
        }
    }
}

/// A dark surface with a bright node behind a mirror at one corner.
RecordBand mirrored_point(double primary_z_m, double node_z_m, const Mat2& w) {
    return corner_band(80, 80, 0, [&](int x, int y) {
        std::vector nodes{corner(primary_z_m, 0, 0, 0)};
        if (x == 40 && y == 40) {
            Record node = corner(node_z_m, 100, 100, 100);
            node.path = NodePath().child(NodePath::Bounce::reflected);
            node.w = w;
            nodes.push_back(node);
        }
        return nodes;
    });
}

/// Half of the extent of the pixels that are not black, px, along x and y.
std::pair<int, int> extent(const Image& image) {
    int x_least = image.width, x_most = -1, y_least = image.height, y_most = -1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (value(image, x, y, 0) <= 1e-9) continue;
            x_least = std::min(x_least, x);
            x_most = std::max(x_most, x);
            y_least = std::min(y_least, y);
            y_most = std::max(y_most, y);
        }
    }
    return {(x_most - x_least + 1) / 2, (y_most - y_least + 1) / 2};
}

TEST(Scatter, EachDepthModelTakesItsOwnDepth) {
    // The radii are 3 px by the primary depth, 8 px by the path length and 20 px by W.
    const RecordBand band = mirrored_point(1.0 / 3, 1.0 / 8, Mat2::isotropic(20));
    const auto radius = [&](DepthModel model) { return extent(scattered(band, 0, {.model = model})).first; };
    EXPECT_NEAR(radius(DepthModel::first_hit), 3, 1);
    EXPECT_NEAR(radius(DepthModel::path), 8, 1);
    EXPECT_NEAR(radius(DepthModel::ray_differentials), 20, 1);
    for (const DepthModel model : {DepthModel::first_hit, DepthModel::path, DepthModel::ray_differentials}) {
        EXPECT_NEAR(point_of(scattered(band, 0, {.model = model})).energy, 100, 0.01);
    }
}

TEST(Scatter, MirrorSpreadsItsImageOverAnEllipse) {
    const Mat2 w{12, 4, 4, 24};
    const Image image = scattered(mirrored_point(1, 1, w), 0);
    // The half extents of the ellipse of M = -W are the lengths of the rows of M.
    const auto [across, down] = extent(image);
    EXPECT_NEAR(across, std::hypot(12, 4), 1.01);
    EXPECT_NEAR(down, std::hypot(4, 24), 1.01);
    const Point p = point_of(image);
    EXPECT_NEAR(p.energy, 100, 0.01);
    EXPECT_NEAR(p.x, 40, 0.01);
    EXPECT_NEAR(p.y, 40, 0.01);
    // The second moments of a uniform ellipse are M M^T / 4, plus 1/12 for a pixel.
    double xx = 0, xy = 0, yy = 0;
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 80; ++x) {
            const double v = value(image, x, y, 0) / p.energy, dx = x + 0.5 - p.x, dy = y + 0.5 - p.y;
            xx += v * dx * dx;
            xy += v * dx * dy;
            yy += v * dy * dy;
        }
    }
    // An error of 1/8 px of the outline changes the moments by at most a quarter of the semi-axis.
    EXPECT_NEAR(xx - 1 / 12.0, (12 * 12 + 4 * 4) / 4.0, 0.8);
    EXPECT_NEAR(xy, (12 * 4 + 4 * 24) / 4.0, 1.0);
    EXPECT_NEAR(yy - 1 / 12.0, (4 * 4 + 24 * 24) / 4.0, 1.6);
}

TEST(Scatter, FlatMirrorNeedsNoW) {
    std::mt19937 random(37);
    std::uniform_real_distribution<double> depth(0.2, 3);
    const RecordBand band = corner_band(60, 40, 0, [&](int, int) {
        std::vector nodes{corner(2, 0.1F, 0.1F, 0.1F), corner(depth(random), 0.5F, 0.2F, 0.3F)};
        nodes[1].path = NodePath().child(NodePath::Bounce::reflected);
        return nodes;
    });
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px = 9000;
    EXPECT_LT(difference(scattered(band, 0, {.geometry = geometry, .model = DepthModel::ray_differentials}),
                         scattered(band, 0, {.geometry = geometry, .model = DepthModel::path})),
              1e-6);
}

TEST(Scatter, VanishingCocIsTheTracedPicture) {
    std::mt19937 random(41);
    for (const int levels : {0, 1, 3, 8}) {
        const RandomOptions options{.levels = levels, .probability = levels > 3 ? 0.3 : 0.5, .has_w = true};
        const RecordBand band = random_band(random, -2, 33, -2, 28, options);
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px = 1e-3;
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            const Image image = scattered(band, 2, {.geometry = geometry, .model = model});
            for (int y = 0; y < image.height; ++y) {
                std::vector<float> row(static_cast<std::size_t>(image.width) * 3);
                picture_row(band, y, 0, image.width, row);
                for (std::size_t i = 0; i < row.size(); ++i) {
                    const double wanted = static_cast<double>(row[i]);
                    ASSERT_NEAR(static_cast<double>(image.pixel(0, y)[i]), wanted,
                                1e-6 * std::max(1.0, wanted))
                        << levels << " " << y << " " << i;
                }
            }
        }
    }
}

void expect_sane(const Image& image, double least, double most) {
    for (const float v : image.rgb) {
        ASSERT_TRUE(std::isfinite(v));
        ASSERT_GE(static_cast<double>(v), least * (1 - 1e-5));
        ASSERT_LE(static_cast<double>(v), most * (1 + 1e-5));
    }
}

TEST(Scatter, ExtremeDepthsAndFocusesAreFinite) {
    std::mt19937 random(43);
    std::uniform_real_distribution<float> colour(0.25F, 1);
    const std::vector<double> depths{infinity, 1e-6, 1e-38, 0.01, 0.03, 1, 1e6};
    const RecordBand band = corner_band(48, 32, 0, [&](int x, int y) {
        return std::vector{corner(depths[static_cast<std::size_t>(x / 7 + y / 6) % depths.size()],
                                  colour(random), colour(random), colour(random))};
    });
    for (const double inverse_focus : {0.0, 0.2, 1 / 0.03}) {
        FocusGeometry geometry = lens_geometry;
        geometry.inverse_focus_per_m = inverse_focus;
        for (const auto spacing : {DepthSpacing::inverse, DepthSpacing::linear}) {
            for (const auto k : {std::optional<int>(), std::optional<int>(7)}) {
                const auto tables =
                    tables_of(band, 0, {.geometry = geometry, .spacing = spacing, .depths = k});
                Image image;
                scatter(*tables, image);
                expect_sane(image, 0.25, 1);
                EXPECT_TRUE(std::isfinite(tables->largest_coc_px()));
            }
        }
    }
}

TEST(Scatter, CircleOfSeveralFramesIsTheMeanOfThePicture) {
    std::mt19937 random(47);
    std::uniform_real_distribution<float> colour(0, 1);
    // CoCs of several image widths, of more than the largest radius, and extreme W as near a caustic.
    for (const double radius : {500.0, 2e5, 1e9}) {
        double sum = 0;
        const RecordBand band = corner_band(64, 48, 0, [&](int, int) {
            const float v = colour(random);
            sum += static_cast<double>(v);
            return std::vector{corner(1 / radius, v, v, v)};
        });
        const Image image = scattered(band, 0);
        const double mean = sum / (65 * 49);
        // Samples at the border have half of the weight.
        for (const float v : image.rgb) ASSERT_NEAR(static_cast<double>(v), mean, 0.01) << radius;
    }
    const Image caustic = scattered(mirrored_point(1, 1, {1e20F, 3e12F, -1e7F, 1e-20F}), 0);
    expect_sane(caustic, 0, 100);
}

TEST(Scatter, NegativeColoursPassThrough) {
    const Image image =
        scattered(corner_band(20, 20, 0, [](int, int) { return std::vector{corner(0.2, -1, 2, -3)}; }), 0);
    EXPECT_NEAR(value(image, 10, 10, 0), -1, 1e-6);
    EXPECT_NEAR(value(image, 10, 10, 2), -3, 3e-6);
}

TEST(Scatter, IsTheSameForAnyNumberOfThreads) {
    std::mt19937 random(53);
    const RecordBand band =
        random_band(random, -3, 80, -3, 70, {.levels = 2, .probability = 0.2, .has_w = true});
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px = 15000;
    std::vector<float> first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const Image image = scattered(band, 3, {.geometry = geometry});
        if (first.empty()) first = image.rgb;
        EXPECT_EQ(image.rgb, first) << threads;
    }
}

}  // namespace
}  // namespace postlens::test::scatter_test
