// The layers method on records in memory: closed forms, hidden surfaces, masks of mirrors, and the fast
// version against the reference version.
#include "focus/layers/layers.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "core/threads.h"
#include "focus/layers/visibility.h"
#include "records/quadtree.h"
#include "tests/focus/focus_records.h"
#include "tests/focus/level_radius.h"
#include "tests/support/random_records.h"

namespace postlens {
namespace {

using namespace test;

constexpr float infinity = std::numeric_limits<float>::infinity();

std::unique_ptr<LayerSplats> splats_of(const RecordBand& band, int overscan_px, const TableOptions& o = {},
                                       std::shared_ptr<const ResponseModel> response = nullptr) {
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end};
    const RasterWindow picture{band.x_begin + overscan_px, band.x_end - overscan_px - 1,
                               band.y_begin + overscan_px, band.y_end - overscan_px - 1};
    auto splats = std::make_unique<LayerSplats>(source, picture, o.geometry,
                                                DepthLevels(o.geometry, range_of(band), o.spacing, o.depths),
                                                o.model, std::move(response));
    splats->add_rows(band, band.y_begin, band.y_end);
    splats->finish();
    return splats;
}

Image layered(const RecordBand& band, int overscan_px, const TableOptions& options = {}) {
    Image image;
    layers(*splats_of(band, overscan_px, options), image);
    return image;
}

/// A record of object `id` at a depth and in a layer.
Record of(std::uint32_t id, double z_m, const std::array<float, 3>& rgb, std::uint32_t layer = 0) {
    Record r = corner(z_m, rgb[0], rgb[1], rgb[2]);
    r.id = id;
    r.layer = layer;
    return r;
}

/// A step edge blurred by a disc of radius 1, at distance t from the edge.
double edge_response(double t) {
    if (t <= -1) return 0;
    if (t >= 1) return 1;
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
}

constexpr std::array<float, 3> red{1, 0.5F, 0}, blue{0, 0.25F, 1};

// --- closed forms
// ------------------------------------------------------------------------------------------------

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

// --- one surface
// -------------------------------------------------------------------------------------------------

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

// --- mirrors
// -----------------------------------------------------------------------------------------------------

constexpr NodePath reflected = NodePath().child(NodePath::Bounce::reflected);

Record shown(std::uint32_t id, double z_m, const std::array<float, 3>& rgb, NodePath path = reflected,
             std::uint32_t layer = 0) {
    Record r = of(id, z_m, rgb, layer);
    r.path = path;
    return r;
}

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
        nodes.push_back(shown(4, 1 / 10.0, rgb, reflected, x >= x0 ? 1 : 0));
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
    const NodePath twice = reflected.child(NodePath::Bounce::reflected);
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
    const NodePath twice = reflected.child(NodePath::Bounce::reflected);
    const RecordBand band = corner_band(40, 30, 20, [&](int x, int) {
        std::vector nodes{of(1, 1 / 10.0, {0, 0, 0})};
        if (x >= x0) {
            nodes.push_back(shown(2, 1 / (10 + near_px), {0, 0, 0.25F}));
            nodes.push_back(shown(5, 1 / 10.0, {0, 0, 0.5F}, twice));
        }
        nodes.push_back(shown(4, 1 / 10.0, {0.8F, 0, 0}, reflected, x >= x0 ? 1 : 0));
        return nodes;
    });
    const Image image = layered(band, 20, {.geometry = geometry});
    for (int x = 0; x < 40; ++x) {
        const double front = edge_response((x + 1 - x0) / near_px);
        ASSERT_NEAR(value(image, x, 15, 0), 0.8 * (1 - front), x == x0 - 1 ? 0.02 : 1e-5) << x;
        ASSERT_NEAR(value(image, x, 15, 2), 0.75 * front, 1e-5) << x;
    }
}

// --- the fast form, limits
// ---------------------------------------------------------------------------------------

/// Random records of interpenetrating objects, mirrors, hidden layers, and hidden nodes after bounces.
RecordBand tangle(std::mt19937& random, int overscan_px, int width, int height) {
    RecordBand band =
        random_band(random, -overscan_px, width + overscan_px + 1, -overscan_px, height + overscan_px + 1,
                    {.levels = 2, .probability = 0.3, .has_w = true, .has_layers = true});
    for (Record& r : band.records) {
        r.id = (r.id + static_cast<std::uint32_t>(std::abs(r.x) / 9)) % 5;
        if (r.layer == 1 && r.id == 3) r.path = reflected;
    }
    return band;
}

TEST(Layers, EqualsTheReference) {
    std::mt19937 random(41);
    for (const double scale : {1e-6, 0.3, 3.0, 40.0}) {
        const RecordBand band = tangle(random, 4, 75, 70);
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px *= scale;
        geometry.inverse_focus_per_m = 0.3;
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            const auto splats = splats_of(band, 4, {.geometry = geometry, .model = model});
            Image fast;
            layers(*splats, fast);
            // Tolerance: sums of 1e4 terms in another order, for colours of up to 4.
            EXPECT_LT(difference(fast, layers_reference(*splats)), 2e-5) << scale;
        }
    }
}

TEST(Layers, EqualsTheReferenceForOtherApertures) {
    std::mt19937 random(43);
    const RecordBand band = tangle(random, 4, 40, 30);
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px *= 6;
    geometry.inverse_focus_per_m = 0.3;
    std::vector<Impulse> impulses(3);
    impulses[0].kind = ImpulseKind::polygon;
    impulses[0].blades = 5;
    impulses[1] = impulses[0];
    impulses[1].cats_eye = 0.8;
    impulses[2].kind = ImpulseKind::diffraction;
    for (const Impulse& impulse : impulses) {
        const std::shared_ptr<const ResponseModel> response = response_model(impulse, geometry, 25);
        const auto splats = splats_of(band, 4, {.geometry = geometry}, response);
        EXPECT_EQ(splats->kernels().channels(), impulse.kind == ImpulseKind::diffraction ? 3U : 1U);
        Image fast;
        layers(*splats, fast);
        EXPECT_LT(difference(fast, layers_reference(*splats)), 2e-5) << impulse_text(impulse);
    }
}

TEST(Layers, IsTheSameBitsForAnyNumberOfThreads) {
    std::mt19937 random(47);
    const RecordBand band = tangle(random, 4, 140, 130);
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px *= 4;
    geometry.inverse_focus_per_m = 0.3;
    std::vector<Image> images;
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        images.push_back(layered(band, 4, {.geometry = geometry}));
    }
    EXPECT_EQ(images[0].rgb, images[1].rgb);
    EXPECT_EQ(images[0].rgb, images[2].rgb);
}

TEST(Layers, AnyLensGivesFinitePicturesBetweenTheDarkestAndTheBrightest) {
    std::mt19937 random(53);
    const RecordBand band = tangle(random, 2, 24, 16);
    std::array<float, 3> most{};
    // Sums the visible nodes of each sample with all reflected ones. Hidden nodes after bounces are added to
    // the nodes in front of them.
    for (std::size_t k = 0; k + 1 < band.offsets.size(); ++k) {
        for (std::size_t i = band.offsets[k]; i < band.offsets[k + 1]; ++i) {
            std::array<float, 3> sum{};
            const Record& first = band.records[i];
            for (std::size_t j = i; j < band.offsets[k + 1]; ++j) {
                const Record& r = band.records[j];
                if (r.x == first.x && r.y == first.y && r.layer == first.layer) {
                    sum = {sum[0] + r.r, sum[1] + r.g, sum[2] + r.b};
                }
            }
            for (std::size_t c = 0; c < 3; ++c) most[c] = std::max(most[c], sum[c]);
        }
    }
    for (const double f_number : {0.5, 1.4, 8.0, 64.0}) {
        for (const double focus_m : {0.1, 0.7, 3.0, 1e6, static_cast<double>(infinity)}) {
            // These settings make CoCs of up to four image widths.
            const FocusGeometry geometry{.aperture_radius_m = 0.025 / f_number,
                                         .inverse_focus_per_m = 1 / focus_m,
                                         .gain_px = 200,
                                         .zoom = 1};
            const Image image = layered(band, 2, {.geometry = geometry});
            for (std::size_t i = 0; i < image.rgb.size(); ++i) {
                ASSERT_TRUE(std::isfinite(image.rgb[i])) << f_number << " " << focus_m;
                ASSERT_GE(image.rgb[i], 0) << f_number << " " << focus_m;
                ASSERT_LE(image.rgb[i], most[i % 3]) << f_number << " " << focus_m;
            }
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

TEST(Composite, LiesOver) {
    // Without moments and far apart in depth, alphas are multiplied.
    const FocusGeometry geometry{
        .aperture_radius_m = 1e-3, .inverse_focus_per_m = 10, .gain_px = 1000, .zoom = 1};
    const auto fragment = [](double inverse_m, double seen, double hidden, double grey, double covered = 0) {
        Fragment f{.inverse_depth_per_m = inverse_m, .seen = {}, .hidden = {}};
        f.seen.alpha = seen;
        f.hidden.alpha = hidden;
        f.seen.rgb.fill(seen * grey);
        f.hidden.rgb.fill(hidden * grey);
        f.covered = covered;
        return f;
    };
    std::vector<Fragment> two{fragment(0, 0.5, 0.5, 1), fragment(40, 0.3, 0, 4)};
    EXPECT_NEAR(composite(two, geometry)[0], 0.3 * 4 + 0.7, 1e-12);
    std::vector<Fragment> three{fragment(-100, 1, 0, 8), fragment(0, 0.5, 0, 1), fragment(40, 0.3, 0, 4)};
    EXPECT_NEAR(composite(three, geometry)[0], 0.3 * 4 + 0.7 * (0.5 + 0.5 * 8), 1e-12);
    // With equal CoCs, only the visible parts count, not the hidden ones.
    std::vector<Fragment> together{fragment(20, 0.5, 0.5, 1, 0.5), fragment(20.001, 0.25, 0, 4),
                                   fragment(20, 0.25, 0, 2)};
    EXPECT_NEAR(composite(together, geometry)[0], 0.25 * 4 + 0.25 * 2 + 0.5, 1e-3);
    // If nothing is recorded behind a fragment, the result is divided by its coverage.
    std::vector<Fragment> half{fragment(20, 0.5, 0, 3)};
    EXPECT_NEAR(composite(half, geometry)[0], 3, 1e-12);
    EXPECT_EQ(composite({}, geometry), (std::array<double, 3>{}));
}

}  // namespace
}  // namespace postlens
