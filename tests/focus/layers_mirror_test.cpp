// The layers method on records in memory: masks of mirrors.
#include <array>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "tests/focus/focus_records.h"
#include "tests/focus/layer_records.h"
#include "tests/focus/level_radius.h"
#include "tests/support/edge_response.h"

namespace postlens::test::layers_mirror_test {
namespace {

TEST(Layers, AMirrorsOutlineIsBlurredAsTheMirrorAndItsImageAsTheImage) {
    // A mirror with a straight border and a blur of 4.95 px shows an edge in focus, in front of a black wall.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 10;
    const double mirror_px = level_radius(4.95);
    constexpr int border = 50, edge = 20;
    const RecordBand band = corner_band(80, 8, 20, [&](int x, int) {
        const Record wall = of(2, 1 / 9.0, {0, 0, 0});
        if (x >= border) return std::vector{wall};
        Record hidden = wall;
        hidden.layer = 1;
        const std::array<float, 3>& rgb = x < edge ? red : blue;
        return std::vector{of(1, 1 / (10 + mirror_px), {0, 0, 0}), shown(x < edge ? 3U : 4U, 1 / 10.0, rgb),
                           hidden};
    });
    const Image image = layered(band, 20, {.geometry = geometry});
    for (int x = 0; x < 80; ++x) {
        const double mask = edge_response((border - x - 1) / mirror_px);
        const double left = x + 1 < edge ? 1 : x + 1 == edge ? 0.5 : 0;
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(c);
            const double picture =
                left * static_cast<double>(red[k]) + (1 - left) * static_cast<double>(blue[k]);
            // Beyond the mirror's border, its image continues with the colours of the border.
            ASSERT_NEAR(value(image, x, 4, c), mask * picture, 2e-6) << x;
        }
    }
}

TEST(Layers, AMirrorThatIsPartlyMattShowsItsShare) {
    // Every other column reflects. The mirror is out of focus, its image is in focus.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 10;
    const RecordBand band = corner_band(60, 40, 20, [&](int x, int) {
        std::vector nodes{of(1, 1 / (10 + 9.9), {0.2F, 0.2F, 0.2F})};
        if (x % 2 == 0) nodes.push_back(shown(3, 1 / 10.0, {0.5F, 1, 0}));
        return nodes;
    });
    const Image image = layered(band, 20, {.geometry = geometry});
    for (int x = 0; x < 60; ++x) {
        // The disc averages the columns to 1/2, up to the weight of one column, 2 / (pi radius).
        EXPECT_NEAR(value(image, x, 20, 0), 0.2 + 0.25, 0.5 * 2 / (std::numbers::pi * 9.9));
        EXPECT_NEAR(value(image, x, 20, 1), 0.2 + 0.5, 2 / (std::numbers::pi * 9.9));
    }
}

TEST(Layers, WhatHidesInAMirrorComesToLight) {
    // A mirror in focus shows a near half-plane in front of a texture. The hidden part of the texture is
    // recorded as nodes of layer 1 without a primary node.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 10;
    const double near_px = level_radius(9.9);
    constexpr int x0 = 30;
    const auto level = [](int x) { return 0.5F + 0.4F * std::sin(0.7F * static_cast<float>(x)); };
    const RecordBand band = corner_band(60, 30, 20, [&](int x, int) {
        std::vector nodes{of(1, 1 / 10.0, {0, 0, 0})};
        const std::array<float, 3> rgb{level(x), 0.25F, 0};
        if (x >= x0) nodes.push_back(shown(3, 1 / (10 + near_px), blue));
        nodes.push_back(shown(4, 1 / 10.0, rgb, reflected_path, x >= x0 ? 1 : 0));
        return nodes;
    });
    const Image image = layered(band, 20, {.geometry = geometry});
    for (int x = 0; x < 60; ++x) {
        const double front = edge_response((x + 1 - x0) / near_px);
        const double behind = (static_cast<double>(level(x)) + static_cast<double>(level(x + 1))) / 2;
        // In the pixel at the border, visible and hidden parts are mixed.
        ASSERT_NEAR(value(image, x, 15, 0), (1 - front) * behind, x == x0 - 1 ? 0.02 : 2e-6) << x;
        ASSERT_NEAR(value(image, x, 15, 2), front, 2e-6) << x;
    }
}

TEST(Layers, MirrorsInMirrorsAddUp) {
    // A mirror shows a mirror that shows a wall, each uniform and at its own depth.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 10;
    const NodePath twice = reflected_path.child(NodePath::Bounce::reflected);
    const RecordBand band = corner_band(40, 30, 20, [&](int, int) {
        return std::vector{of(1, 1 / 15.0, {0.1F, 0, 0}), shown(2, 1 / 12.0, {0, 0.2F, 0}),
                           shown(1, 1 / 3.0, {0.3F, 0.3F, 0.3F}, twice)};
    });
    const Image image = layered(band, 20, {.geometry = geometry});
    for (int x = 0; x < 40; ++x) {
        ASSERT_NEAR(value(image, x, 15, 0), 0.4, 2e-6);
        ASSERT_NEAR(value(image, x, 15, 1), 0.5, 2e-6);
        ASSERT_NEAR(value(image, x, 15, 2), 0.3, 2e-6);
    }
}

TEST(Layers, WhatAMirrorInAMirrorHidesDoesNotDarkenIt) {
    // A mirror in focus shows a near mirror with an edge, in front of a wall that is recorded behind it. The
    // image in the near mirror, in focus, must fill it up to its soft edge.
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 10;
    const double near_px = level_radius(5.88);
    constexpr int x0 = 20;
    const NodePath twice = reflected_path.child(NodePath::Bounce::reflected);
    const RecordBand band = corner_band(40, 30, 20, [&](int x, int) {
        std::vector nodes{of(1, 1 / 10.0, {0, 0, 0})};
        if (x >= x0) {
            nodes.push_back(shown(2, 1 / (10 + near_px), {0, 0, 0.25F}));
            nodes.push_back(shown(5, 1 / 10.0, {0, 0, 0.5F}, twice));
        }
        nodes.push_back(shown(4, 1 / 10.0, {0.8F, 0, 0}, reflected_path, x >= x0 ? 1 : 0));
        return nodes;
    });
    const Image image = layered(band, 20, {.geometry = geometry});
    for (int x = 0; x < 40; ++x) {
        const double front = edge_response((x + 1 - x0) / near_px);
        ASSERT_NEAR(value(image, x, 15, 0), 0.8 * (1 - front), x == x0 - 1 ? 0.02 : 1e-5) << x;
        ASSERT_NEAR(value(image, x, 15, 2), 0.75 * front, 1e-5) << x;
    }
}

}  // namespace
}  // namespace postlens::test::layers_mirror_test
