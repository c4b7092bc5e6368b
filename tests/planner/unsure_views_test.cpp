// Rays replace unsure view samples: the result is as accurate as with a ray for every view sample, with few
// rays.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "planner/hybrid.h"
#include "tests/planner/lens_case.h"
#include "tests/support/quads.h"
#include "tests/support/reference.h"
#include "tests/support/temporary_folder.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/distributed/scene_rays.h"
#include "tracer/render.h"

namespace postlens::test::unsure_views_test {
namespace {

using glm::dvec3;

class UnsureViews : public testing::TestWithParam<Case> {};

TEST_P(UnsureViews, AreAsRightAsRays) {
    const Case& c = GetParam();
    const Scene scene = small(c.scene);
    const TracedFrame frame(scene, traced_for(c));
    const double focal_length_mm = frame.file().header().focal_length_mm;
    const Reference truth = reference(scene, by_rays(c, focal_length_mm, 256, 9));
    constexpr int views = 64;
    HybridSettings s = hybrid_of(c, focal_length_mm, views);
    s.scene = &scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    const double of_rays = encoded_psnr(rendered(scene, c, focal_length_mm, views, 5, true), truth);
    EXPECT_GT(encoded_psnr(got.focus.image, truth), std::min(50.0, of_rays - 0.5));
    EXPECT_LT(got.retraced_share, 0.5);
    ASSERT_TRUE(got.stated);
    // The edges of highlights are measured by about 4096 * 256 rays at most, for those seen directly and
    // again for those in mirrors and glass.
    const std::int64_t measuring = static_cast<std::int64_t>(got.rays.eye) -
                                   std::lround(got.retraced_share * 96 * 54 * views) -
                                   static_cast<std::int64_t>(got.stated->check_rays);
    EXPECT_GE(measuring, 0);
    EXPECT_LE(measuring, 2 * 4096 * 256);
}

INSTANTIATE_TEST_SUITE_P(Scenes, UnsureViews,
                         testing::Values(Case{"bars.toml", 1.4, 5}, Case{"bars.toml", 5.6, 5},
                                         Case{"bars_lit.toml", 1.4, 5}, Case{"bars_lit.toml", 5.6, 5},
                                         Case{"night.toml", 1.4, 4}, Case{"night.toml", 5.6, 4},
                                         Case{"still_life.toml", 1.4, 1.2},
                                         Case{"still_life.toml", 5.6, 1.2}),
                         [](const auto& p) {
                             return p.param.scene.substr(0, p.param.scene.find('.')) + "_" +
                                    std::to_string(std::lround(10 * p.param.f_number));
                         });

// The leaves of a tree are one mesh, as modelling programs export them. Many are narrower than a pixel, and
// there are gaps between them that no corner sees.
TEST(UnsureViews, LeavesOfOneMeshAreAsRightAsRays) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const auto direction = [&] {
        return glm::normalize(dvec3(normal(random), normal(random), normal(random)));
    };
    std::vector<Quad> leaves;
    for (int i = 0; i < 300; ++i) {
        const dvec3 at = dvec3(0, 0, -5.5) + 0.9 * direction(), u = 0.03 * direction(),
                    v = 0.015 * glm::normalize(glm::cross(u, direction()));
        leaves.push_back({at - u, at - v, at + u, at + v});
    }
    SceneBuilder b;
    b.scene.background = dvec3(0.45, 0.6, 0.9);
    b.add(mesh_of(leaves), glowing(dvec3(0.05, 0.2, 0.04)));
    const Case c{"", 1.4, 5};
    const TracedFrame frame(b.scene, traced_for(c));
    HybridSettings s = hybrid_of(c, 50, 64);
    s.scene = &b.scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    const Reference truth = reference(b.scene, by_rays(c, 50, 256, 9));
    EXPECT_GT(encoded_psnr(got.focus.image, truth),
              encoded_psnr(rendered(b.scene, c, 50, 64, 5, true), truth) - 0.5);
    EXPECT_LT(got.retraced_share, 0.5);
}

/// An image of 256 views from records of one level, and its PSNR and that of as many rays.
struct ManyViews {
    HybridResult hybrid;
    double psnr_db = 0, psnr_of_rays_db = 0;
};

ManyViews many_views(const Scene& scene, const Case& c) {
    TraceSettings trace = traced_for(c);
    trace.subdivision.levels = 1;
    const TracedFrame frame(scene, trace);
    HybridSettings s = hybrid_of(c, 50, 256);
    s.scene = &scene;
    ManyViews out{.hybrid = hybrid_picture(frame.file(), s)};
    const Reference truth = reference(scene, by_rays(c, 50, 1024, 9));
    out.psnr_db = encoded_psnr(out.hybrid.focus.image, truth);
    out.psnr_of_rays_db = encoded_psnr(rendered(scene, c, 50, 256, 5, true), truth);
    return out;
}

// The images in a mirror ball move so little over a small lens that they are drawn as part of the ball. Near
// the horizon in the ball, the floor's cells are finer than the samples: all corners of a leaf may show one
// colour.
TEST(UnsureViews, ATextureFinerThanTheSamplesIsUnsureInAMirrorBallToo) {
    SceneBuilder b;
    b.scene.background = dvec3(0.2, 0.3, 0.5);
    Material floor = glowing(dvec3(1));
    floor.emission_texture = std::make_shared<const Texture>(Checker{
        .size = dvec3(0.3), .offset = dvec3(0.013, 0.017, 0.019), .even = dvec3(0.9), .odd = dvec3(0.1)});
    b.add(Plane{.point = dvec3(0, -0.7, 0), .normal = dvec3(0, 1, 0)}, floor);
    Material mirror = glowing(dvec3(0));
    mirror.reflection = dvec3(0.85);
    b.add(Sphere{dvec3(0.2, -0.1, -2.2), 0.5}, mirror);
    const ManyViews made = many_views(b.scene, {"", 5, 2});
    EXPECT_GT(made.psnr_db, made.psnr_of_rays_db - 0.5);
    EXPECT_LT(made.hybrid.retraced_share, 0.5);
}

// A frosted pane before a fine pattern. The means over its lobe have as much noise in the records as some 100
// rays, so 256 views are better as rays. Check rays look through the pane by chance, and must still tell so.
TEST(UnsureViews, BehindFrostedGlassRaysReplaceManyViews) {
    SceneBuilder b;
    Material wall = glowing(dvec3(1));
    wall.emission_texture = std::make_shared<const Texture>(Checker{
        .size = dvec3(0.06), .offset = dvec3(0.013, 0.017, 0.019), .even = dvec3(0.8), .odd = dvec3(0.1)});
    b.add(Plane{dvec3(0, 0, -3), dvec3(0, 0, 1)}, wall);
    Material pane = glowing(dvec3(0));
    pane.transmission = dvec3(0.9);
    pane.transmission_exponent = 300;
    b.add(Rectangle{dvec3(-0.8, -0.5, -2), dvec3(1.4, 0, 0.2), dvec3(0, 1, 0)}, pane);
    const ManyViews made = many_views(b.scene, {"", 2, 2});
    EXPECT_GT(made.psnr_db, made.psnr_of_rays_db - 1);
    ASSERT_TRUE(made.hybrid.stated);
    EXPECT_GT(made.hybrid.stated->high_db(), made.psnr_db);
    EXPECT_LT(made.hybrid.stated->low_db(), made.psnr_db);
}

// A rectangle brighter than white in front of a cone that passes through its depth. The rectangle has a lobe:
// a record includes the lobe's mean, while rays sample it. The radiance above white is added as a highlight,
// and only once.
TEST(UnsureViews, LightAboveWhiteIsCountedOnce) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "bright.toml";
    std::ofstream(path) << R"(
[scene]
background = [0.48, 0.36, 0.25]
[[camera]]
focal_length_mm = 50
[[light]]
kind = "directional"
intensity = [0.983, 1.013, 0.927]
direction = [0.0024, -0.478, -0.86]
[[light]]
kind = "directional"
intensity = [0.518, 0.365, 0.544]
direction = [0.117, -0.387, -0.671]
[[material]]
name = "bright"
colour = [0.939, 0.986, 0.534]
reflection = 0.213
reflection_exponent = 30
[[object]]
material = "bright"
shape = "rectangle"
corner_m = [0.3285, -0.1346, -1.2178]
edge_u_m = [0.131224, 0.00816861, -0.0651629]
edge_v_m = [-0.0238423, 0.131224, 0.00256993]
[[material]]
name = "cone"
colour = [0.893, 0.689, 0.959]
[[object]]
material = "cone"
shape = "cone"
base_m = [0.36468, -0.000282753, -1.27245]
apex_m = [0.0261869, 0.0502991, -1.5584]
base_radius_m = 0.0891971
)";
    Scene scene = read_scene(path);
    scene.cameras[0].width = 240;
    scene.cameras[0].height = 136;
    const Case c{"", 2, 5.7};
    const TracedFrame frame(scene, traced_for(c));
    const double focal_length_mm = frame.file().header().focal_length_mm;
    const Image truth = rendered(scene, c, focal_length_mm, 256, 9);
    HybridSettings s = hybrid_of(c, focal_length_mm, 64);
    for (const bool with_rays : {false, true}) {
        s.scene = with_rays ? &scene : nullptr;
        const Image got = hybrid_picture(frame.file(), s).focus.image;
        int bright = 0;
        for (std::size_t k = 0; k < truth.rgb.size(); k += 3) {
            // Inside of the rectangle all views see it, except two of 64 at its border.
            if (truth.rgb[k] < 1.0795F) continue;
            ++bright;
            EXPECT_NEAR(got.rgb[k], truth.rgb[k], 2 * 0.6F / 64) << k << " " << with_rays;
        }
        EXPECT_GT(bright, 100);
    }
}

// Check rays do not change the image, and their sum equals the difference from a ray for every view.
TEST(UnsureViews, ChecksTellTheDifferenceToRays) {
    const Case c{"bars.toml", 1.4, 5};
    const Scene scene = small(c.scene);
    TraceSettings coarse = traced_for(c);
    coarse.subdivision.levels = 0;
    const TracedFrame frame(scene, coarse);
    constexpr int views = 16;
    HybridSettings s = hybrid_of(c, frame.file().header().focal_length_mm, views);
    s.scene = &scene;
    s.checked = [](int, int, std::vector<std::uint32_t>&) {};
    const Image plain = hybrid_picture(frame.file(), s).focus.image;
    s.checked = [](int, int, std::vector<std::uint32_t>& all) {
        for (std::uint32_t v = 0; v < views / 2; ++v) all.push_back(v);
    };
    const HybridResult checked = hybrid_picture(frame.file(), s);
    EXPECT_EQ(checked.focus.image.rgb, plain.rgb);

    RenderSettings r;
    r.focal_length_mm = s.focus.lens.focal_length_mm;
    r.f_number = c.f_number;
    r.focus_m = c.focus_m;
    const RenderSetup setup(scene, r);
    const SceneRays rays(setup, {}, views);
    // Pieces of 4 px use 61 scrambles in turn.
    ASSERT_EQ(piece_px(96, 54), 4);
    std::array<std::vector<SightLine>, 61> ways;
    for (std::uint32_t scramble = 0; scramble < ways.size(); ++scramble) {
        for (std::uint32_t set = 2 * scramble; set < 2 * scramble + 2; ++set) {
            const auto points = lens_view_points(Aperture(Impulse{}), *checked.focus.geometry, views / 2,
                                                 static_cast<int>(set));
            for (std::uint32_t v = 0; v < views / 2; ++v)
                ways[scramble].push_back(
                    {0, 0, points[v].place, points[v].lens, points[v].light_before, set, v});
        }
    }
    double found = 0;
    for (int y = 0; y < 54; ++y) {
        for (int x = 0; x < 96; ++x) {
            std::vector<SightLine> lines = ways[static_cast<std::size_t>((x / 4 + 23 * (y / 4)) % 61)];
            for (SightLine& line : lines) {
                line.x = x;
                line.y = y;
            }
            std::vector<std::array<float, 3>> seen(lines.size());
            rays.trace(lines, {}, seen);
            const auto k = static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x);
            for (std::size_t n = 0; n < 3; ++n) {
                double mean = 0;
                for (const auto& radiance : seen) mean += static_cast<double>(radiance[n]) / views;
                const double off = static_cast<double>(checked.checks[k].sum[n]) / views;
                // Tolerance: float rounding of colours of about 1.
                ASSERT_NEAR(static_cast<double>(plain.rgb[3 * k + n]) + off, mean, 1e-5) << x << ',' << y;
                found += std::abs(off);
            }
        }
    }
    EXPECT_GT(found, 0);
}

// Nothing is recorded beyond the border of the records, where a bar that they cut continues.
TEST(UnsureViews, KnowThatThingsGoOnBeyondTheBorder) {
    const Case c{"bars.toml", 1.4, 5};
    const Scene scene = small(c.scene);
    const TracedFrame frame(scene, traced_for(c));  // without overscan
    HybridSettings s = hybrid_of(c, frame.file().header().focal_length_mm, 64);
    s.scene = &scene;
    const Image got = hybrid_picture(frame.file(), s).focus.image;
    const Reference truth = reference(scene, by_rays(c, s.focus.lens.focal_length_mm, 256, 9));
    const Image of_rays = rendered(scene, c, s.focus.lens.focal_length_mm, 64, 5, true);
    const auto border_error = [&](const Image& image) {
        double sum = 0;
        for (int y = 0; y < 54; ++y) {
            for (int x = 0; x < 96; ++x) {
                if (x >= 3 && y >= 3 && x < 93 && y < 51) continue;
                for (int n = 0; n < 3; ++n) {
                    const auto v = static_cast<double>(image.pixel(x, y)[n]);
                    sum += (v - truth.halves[0].pixel(x, y)[n]) * (v - truth.halves[1].pixel(x, y)[n]);
                }
            }
        }
        return sum;
    };
    EXPECT_LT(border_error(got), 1.25 * border_error(of_rays));
}

}  // namespace
}  // namespace postlens::test::unsure_views_test
