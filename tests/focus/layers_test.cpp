// The layers method on records in memory: closed forms and hidden surfaces.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

#include "records/quadtree.h"
#include "tests/focus/focus_records.h"
#include "tests/focus/layer_records.h"
#include "tests/focus/level_radius.h"
#include "tests/support/edge_response.h"
#include "tests/support/random_records.h"

namespace postlens::test::layers_test {
namespace {

TEST(Layers, HalfPlaneBeforeABackgroundIsItsOwnEdgeWhateverTheBackground) {
    // The signed radius of a disc has the other sign behind the focus.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 30;
    constexpr int x0 = 40;
    for (const double near_px : {0.5, 3.3, 12.0}) {
        for (const double far_px : {-25.0, -12.0, -3.0, 0.0, 0.4, 3.0, 11.0}) {
            if (far_px >= near_px) continue;
            const RecordBand band = corner_band(80, 6, 30, [&](int x, int) {
                const double near_m = 1 / (30 + near_px), far_m = 1 / (30 + far_px);
                if (x < x0) return std::vector{of(2, far_m, blue)};
                return std::vector{of(1, near_m, red), of(2, far_m, blue, 1)};
            });
            const Image image = layered(band, 30, {.geometry = geometry});
            // The radius of the disc is that of its depth level.
            const double radius_px = level_radius(near_px);
            for (int i = 0; i < 80; ++i) {
                const double front = edge_response((i + 1 - x0) / radius_px);
                for (int c = 0; c < 3; ++c) {
                    const auto k = static_cast<std::size_t>(c);
                    const double wanted =
                        front * static_cast<double>(red[k]) + (1 - front) * static_cast<double>(blue[k]);
                    ASSERT_NEAR(value(image, i, 3, c), wanted, 2e-6) << near_px << " " << far_px << " " << i;
                }
            }
        }
    }
}

TEST(Layers, WhatIsHiddenShinesThroughASoftEdge) {
    // A texture in focus behind a near half-plane: its hidden part has the weight that the half-plane leaves.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 1;
    const auto texture = [](int x, int y) {
        return std::array{0.5F + 0.4F * std::sin(0.7F * static_cast<float>(x)),
                          (x + y) % 2 == 0 ? 0.9F : 0.1F, 0.3F};
    };
    constexpr int x0 = 30;
    const double near_px = level_radius(9.9);
    const RecordBand band = corner_band(60, 24, 16, [&](int x, int y) {
        if (x < x0) return std::vector{of(2, 1, texture(x, y))};
        return std::vector{of(1, 1 / (1 + near_px), red), of(2, 1, texture(x, y), 1)};
    });
    const Image image = layered(band, 16, {.geometry = geometry});
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 60; ++x) {
            const double front = edge_response((x + 1 - x0) / near_px);
            for (int c = 0; c < 3; ++c) {
                const auto k = static_cast<std::size_t>(c);
                double sharp = 0;  // mean of the pixel's corners
                for (const int dy : {0, 1}) {
                    for (const int dx : {0, 1}) sharp += static_cast<double>(texture(x + dx, y + dy)[k]) / 4;
                }
                const double wanted = front * static_cast<double>(red[k]) + (1 - front) * sharp;
                // The radii differ by slightly less than the larger one plus a pixel, so a share of 1 / 10.9
                // moves with the half-plane. This mixes visible and hidden parts in the pixel at the border.
                ASSERT_NEAR(value(image, x, y, c), wanted, x == x0 - 1 ? 0.02 : 2e-6) << x << " " << y;
            }
        }
    }
}

TEST(Layers, ThreeLayersLieOverEachOther) {
    // Two near half-planes at right angles, far apart in depth, in front of a wall. Their edges are
    // independent.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 10;
    constexpr std::array<float, 3> grey{0.2F, 0.2F, 0.2F};
    const double near_px = level_radius(14.85);
    const RecordBand band = corner_band(60, 60, 24, [&](int x, int y) {
        std::vector<Record> nodes;
        const auto add = [&](const Record& r) {
            nodes.push_back(r);
            nodes.back().layer = static_cast<std::uint32_t>(nodes.size()) - 1;
        };
        if (x >= 30) add(of(1, 1 / (10 + near_px), red));
        if (y >= 30) add(of(2, 1 / (10 + 0.0), blue));
        add(of(3, 1 / (10 - 4.95), grey));
        return nodes;
    });
    const Image image = layered(band, 24, {.geometry = geometry});
    for (int y = 20; y < 40; ++y) {
        for (int x = 10; x < 50; ++x) {
            const double front = edge_response((x + 1 - 30) / near_px);
            const double middle = y >= 30 ? 1 : 0;
            for (int c = 0; c < 3; ++c) {
                const auto k = static_cast<std::size_t>(c);
                const double wanted = front * static_cast<double>(red[k]) +
                                      (1 - front) * (middle * static_cast<double>(blue[k]) +
                                                     (1 - middle) * static_cast<double>(grey[k]));
                // The pixels at the sharp edge have corners on both sides.
                if (y == 29) continue;
                ASSERT_NEAR(value(image, x, y, c), wanted, 2e-6) << x << " " << y;
            }
        }
    }
}

TEST(Layers, AHalfCoveredLensSeesThroughItsOtherHalf) {
    // A point light behind the soft edge of a near object. Each pixel of its disc gets the light of one lens
    // point, which is covered or not; with alphas alone, the whole disc would be dimmed.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 30;
    const double light_px = -level_radius(7.92), near_px = level_radius(15.84);
    const RecordBand band = corner_band(60, 40, 30, [&](int x, int y) {
        const float v = x == 30 && y == 20 ? 1000.0F : 0.0F;
        const Record light = of(2, 1 / (30 + light_px), {v, v, v});
        if (x < 30) return std::vector{light};
        Record hidden = light;
        hidden.layer = 1;
        return std::vector{of(1, 1 / (30 + near_px), {0, 0, 0}), hidden};
    });
    const Image image = layered(band, 30, {.geometry = geometry});
    // Light arrives d px from its position through the lens point q = d / 7.92. This lens point sees the part
    // of the near object that the pinhole sees at 30 + d + 15.84 q = 30 + 3 d, so the right half is covered.
    const double whole = 1000 / (std::numbers::pi * light_px * light_px);
    double left = 0, right = 0;
    for (int x = 23; x < 37; ++x) (x < 30 ? left : right) += value(image, x, 20, 0) / whole / 7;
    // The method is of first order: both the covered and the free side have errors of up to 1/6.
    EXPECT_GT(left, 0.8);
    EXPECT_LT(right, 0.2);
}

TEST(Layers, ASurfaceThroughTheFocusIsScatter) {
    // A surface tilted by 45 degrees, from 20 px before to 20 px behind the focus, must have no seam.
    std::mt19937 random(3);
    std::uniform_real_distribution<float> colour(0, 1);
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 100;
    const RecordBand band = corner_band(160, 50, 24, [&](int x, int) {
        const double inverse_m = 100 + (x - 80) * 0.25;
        return std::vector{of(7, 1 / inverse_m, {colour(random), colour(random), colour(random)})};
    });
    const TableOptions options{.geometry = geometry};
    EXPECT_LT(difference(layered(band, 24, options), scattered(band, 24, options)), 1e-5);
}

TEST(Layers, VanishingCocIsTheTracedPicture) {
    std::mt19937 random(29);
    RecordBand band =
        random_band(random, -3, 30, -3, 25, {.levels = 3, .probability = 0.4, .has_layers = true});
    for (Record& r : band.records) r.id %= 4;
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px *= 1e-9;
    const Image image = layered(band, 3, {.geometry = geometry});
    std::vector<float> row(static_cast<std::size_t>(image.width) * 3);
    for (int y = 0; y < image.height; ++y) {
        picture_row(band, y, 0, image.width, row);
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(value(image, x, y, c),
                            static_cast<double>(row[static_cast<std::size_t>(3 * x + c)]), 1e-5)
                    << x << " " << y;
        }
    }
}

TEST(Layers, LightsKeepTheirEnergy) {
    // Lights before, at and behind the focus, on surfaces that fill the frame, so that nothing covers them.
    for (const double radius_px : {-9.9, -4.95, 0.0, 2.97, 7.92}) {
        FocusGeometry geometry = unit_geometry;
        geometry.inverse_focus_per_m = 30;
        const RecordBand band = corner_band(64, 64, 24, [&](int x, int y) {
            const float v = x == 31 && y == 33 ? 5e4F : 0.0F;
            return std::vector{of(x < 32 ? 1 : 2, 1 / (30 + radius_px), {v, 0, 0})};
        });
        const Image image = layered(band, 24, {.geometry = geometry});
        double sum = 0;
        for (std::size_t i = 0; i < image.rgb.size(); i += 3) sum += static_cast<double>(image.rgb[i]);
        EXPECT_NEAR(sum, 5e4, 5e4 * 1e-5) << radius_px;
    }
}

TEST(Layers, ASmallLightBehindSomethingComesToLight) {
    // The light's disc is faint and lies beside a blurred object that hides it from the pinhole. Their radii
    // differ by half of the larger one.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 30;
    // The light and the wall have equal or nearly equal depths, so rounding decides their order.
    for (const double light_px : {level_radius(19.8), level_radius(19.8) + 0.03, level_radius(19.8) - 0.03}) {
        const RecordBand band = corner_band(80, 60, 30, [&](int x, int y) {
            const Record wall = of(3, 1 / (30 - light_px), {0, 0, 0});
            if (x < 40) return std::vector{wall};
            const float v = x == 44 && y == 30 ? 1e4F : 0.0F;
            Record behind = v > 0 ? of(2, 1 / (30 - light_px), {v, v, v}) : wall;
            behind.layer = 1;
            return std::vector{of(1, 1 / (30 - 9.9), {0, 0, 0}), behind};
        });
        const Image image = layered(band, 30, {.geometry = geometry});
        // The half-plane's blurred edge does not reach columns left of 30, so the light alone determines
        // them.
        const double whole = 1e4 / (std::numbers::pi * std::pow(level_radius(light_px), 2));
        // Coverage over the lens is known to first order; wall and light fill a pixel to 1e-3 there.
        for (int x = 26; x < 30; ++x) EXPECT_NEAR(value(image, x, 30, 0), whole, 1e-3 * whole) << x;
        // Halfway through the edge, much of the light remains.
        EXPECT_GT(value(image, 36, 30, 0), 0.3 * whole);
    }
}

}  // namespace
}  // namespace postlens::test::layers_test
