// Rays replace unsure view samples: the result is as accurate as with a ray for every view sample, with few
// rays.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "compare/metrics/pixel_errors.h"
#include "planner/auto_picture.h"
#include "planner/hybrid.h"
#include "planner/views/halved_views.h"
#include "planner/views/tile_grid.h"
#include "tests/support/motion_frame.h"
#include "tests/support/quads.h"
#include "tests/support/reference.h"
#include "tests/support/temporary_folder.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/distributed/scene_rays.h"
#include "tracer/render.h"

namespace postlens::test::unsure_views_test {
namespace {

using glm::dvec3;

/// PSNR of encoded values, dB.
double db(const Image& image, const Image& truth) {
    return pixel_errors(Picture(image), Picture(truth), PixelMask(image.rgb.size() / 3, 1)).psnr_db;
}

struct Case {
    std::string scene;
    double f_number = 1.4, focus_m = 5;
};

Scene small(const std::string& name) {
    Scene scene = read_scene(std::string(POSTLENS_SAMPLES) + "/scenes/" + name);
    scene.cameras[0].width = 96;
    scene.cameras[0].height = 54;
    return scene;
}

TraceSettings traced_for(const Case& c) {
    TraceSettings s;
    s.for_f_number = c.f_number;
    s.for_focus_m = c.focus_m;
    return s;
}

HybridSettings hybrid_of(const Case& c, double focal_length_mm, int views) {
    HybridSettings s;
    s.focus = {.lens = {focal_length_mm, c.f_number}, .focus_distance_m = c.focus_m, .views = views};
    return s;
}

RenderSettings by_rays(const Case& c, double focal_length_mm, int spp, std::uint64_t seed,
                       bool halves = false) {
    RenderSettings s;
    s.focal_length_mm = focal_length_mm;
    s.f_number = c.f_number;
    s.focus_m = c.focus_m;
    s.spp = spp;
    s.seed = seed;
    s.halves = halves;
    return s;
}

Image rendered(const Scene& scene, const Case& c, double focal_length_mm, int spp, std::uint64_t seed,
               bool halves = false) {
    return render_picture(scene, by_rays(c, focal_length_mm, spp, seed, halves)).image;
}

class UnsureViews : public testing::TestWithParam<Case> {};

TEST_P(UnsureViews, AreAsRightAsRays) {
    const Case& c = GetParam();
    const Scene scene = small(c.scene);
    const TracedFrame frame(scene, traced_for(c));
    const double focal_length_mm = frame.file().header().focal_length_mm;
    const Image truth = rendered(scene, c, focal_length_mm, 1024, 9);
    constexpr int views = 64;
    HybridSettings s = hybrid_of(c, focal_length_mm, views);
    s.scene = &scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    const double of_rays = db(rendered(scene, c, focal_length_mm, views, 5, true), truth);
    EXPECT_GT(db(got.focus.image, truth), std::min(50.0, of_rays - 0.5));
    EXPECT_LT(got.retraced_share, 0.5);
    ASSERT_TRUE(got.stated);
    // Up to 4096 pixels at edges of highlights are measured by 256 rays each.
    const std::int64_t measuring = static_cast<std::int64_t>(got.rays.eye) -
                                   std::lround(got.retraced_share * 96 * 54 * views) -
                                   static_cast<std::int64_t>(got.stated->check_rays);
    EXPECT_EQ(measuring % 256, 0);
    EXPECT_GE(measuring, 0);
    EXPECT_LE(measuring, 4096 * 256);
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
    const Image truth = rendered(b.scene, c, 50, 1024, 9);
    EXPECT_GT(db(got.focus.image, truth), db(rendered(b.scene, c, 50, 64, 5, true), truth) - 0.5);
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
    const Image truth = rendered(scene, c, 50, 4096, 9);
    out.psnr_db = db(out.hybrid.focus.image, truth);
    out.psnr_of_rays_db = db(rendered(scene, c, 50, 256, 5, true), truth);
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
                const double off = checked.checks[k].sum[n] / views;
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
    const Image truth = rendered(scene, c, s.focus.lens.focal_length_mm, 1024, 9),
                of_rays = rendered(scene, c, s.focus.lens.focal_length_mm, 64, 5, true);
    const auto border_error = [&](const Image& image) {
        double sum = 0;
        for (int y = 0; y < 54; ++y) {
            for (int x = 0; x < 96; ++x) {
                if (x >= 3 && y >= 3 && x < 93 && y < 51) continue;
                for (int n = 0; n < 3; ++n) {
                    const double d = static_cast<double>(image.pixel(x, y)[n]) - truth.pixel(x, y)[n];
                    sum += d * d;
                }
            }
        }
        return sum;
    };
    EXPECT_LT(border_error(got), 1.25 * border_error(of_rays));
}

// A wall behind all lights. It completes the scene.
void add_wall(SceneBuilder& b) {
    b.add(Rectangle{dvec3(-90, -90, -10), dvec3(180, 0, 0), dvec3(0, 180, 0)}, glowing({0.2, 0.2, 0.2}));
    b.scene.sha256 = std::string(64, 'c');
}

// Images of coarse records: as they are, with the edges of lights measured by rays, and the reference. Only
// the wall is seen outside of `lit`.
struct LightImages {
    Image recorded, measured, truth;
};
LightImages images_of(const Scene& scene, const Case& c, const Crop& lit, int levels = 1) {
    TraceSettings trace = traced_for(c);
    trace.subdivision.levels = levels;
    const TracedFrame frame(scene, trace);
    HybridSettings s = hybrid_of(c, 50, 64);
    LightImages out;
    out.recorded = hybrid_picture(frame.file(), s).focus.image;
    s.scene = &scene;
    out.measured = hybrid_picture(frame.file(), s).focus.image;
    out.truth = rendered_within(scene, by_rays(c, 50, 16384, 9), lit);
    return out;
}

// Records half a pixel apart misjudge the area of a light by about 0.16 px^2 in each pixel at its edge, and
// rays through the pinhole by 0.007 px^2. A light of 9 px^2 has about 16 such pixels.
TEST(UnsureViews, SmallLightsHaveTheAreaThatRaysMeasure) {
    constexpr int lights = 8;
    SceneBuilder b;
    for (int i = 0; i < lights; ++i)
        b.add(Sphere{dvec3(0.36 * (i - 3.5), 0.013 * i, -4), 0.075}, glowing({60, 40, 20}));
    add_wall(b);
    const Case c{"", 1.4, 2.5};
    const LightImages images = images_of(b.scene, c, {0, 16, 64, 16});
    const auto error_of = [&](const Image& image) {
        double square = 0;
        for (int i = 0; i < lights; ++i) {
            double light = 0, right = 0;
            for (int x = i * image.width / lights; x < (i + 1) * image.width / lights; ++x) {
                for (int y = 0; y < image.height; ++y) {
                    light += static_cast<double>(image.pixel(x, y)[1]) - 0.2;
                    right += static_cast<double>(images.truth.pixel(x, y)[1]) - 0.2;
                }
            }
            square += std::pow(light / right - 1, 2) / lights;
        }
        return std::sqrt(square);
    };
    EXPECT_LT(error_of(images.measured), 2 * 0.007 * std::sqrt(16.0) / 9);
    EXPECT_GT(error_of(images.recorded), 5 * error_of(images.measured));
}

// A bright face whose plane almost meets the rim of the lens shows one side of the lens about nine times the
// area that it shows the other. This displaces its light by a fifth of the CoC radius of 3.3 px.
TEST(UnsureViews, AFaceSeenEdgeOnShinesMoreOnOneSideOfTheLens) {
    SceneBuilder b;
    b.add(Rectangle{dvec3(0.06, -0.1, -1.8), dvec3(0, 0, -0.6), dvec3(0, 0.2, 0)}, glowing({60, 40, 20}));
    add_wall(b);
    const Case c{"", 0.5, 1};
    const LightImages images = images_of(b.scene, c, {24, 8, 24, 32});
    // Column of the middle of the face's light, px.
    const auto middle = [](const Image& image) {
        double light = 0, moment = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const double own = static_cast<double>(image.pixel(x, y)[1]) - 0.2;
                light += own;
                moment += own * x;
            }
        }
        return moment / light;
    };
    EXPECT_NEAR(middle(images.measured), middle(images.truth), 0.05);  // measured: 0.013
    EXPECT_GT(std::abs(middle(images.recorded) - middle(images.truth)), 0.3);
    // With six levels, the records of the edges are finer than the rays that would measure these.
    EXPECT_NEAR(middle(images_of(b.scene, c, {24, 8, 24, 32}, 6).measured), middle(images.truth), 0.05);
}

// The plane of a bright face cuts the lens. The lens sees both sides of the face, the pinhole a sliver of
// one, so the records have a fifth of its light.
TEST(UnsureViews, AFaceWhosePlaneCutsTheLensIsLeftToRays) {
    SceneBuilder b;
    b.add(Rectangle{dvec3(0.008, -0.3, -1.8), dvec3(0, 0, -0.6), dvec3(0, 0.5, 0)}, glowing({3, 2, 1.5}));
    add_wall(b);
    const Case c{"", 1, 1.4};
    TraceSettings trace = traced_for(c);
    trace.subdivision.levels = 1;
    const TracedFrame frame(b.scene, trace);
    AutoSettings s{.hybrid = hybrid_of(c, 50, 64), .target_db = 50};
    s.hybrid.scene = &b.scene;
    FocusFrame focus(frame.file());
    const AutoResult got = auto_picture(focus, s);
    ASSERT_TRUE(got.hybrid.stated);
    const Image truth = rendered(b.scene, c, 50, 16384, 9);
    const double measured_db = db(got.hybrid.focus.image, truth);
    // Where the highlights keep the face's light, the image has 41 dB, and 55 dB or more are stated.
    EXPECT_GT(measured_db, got.hybrid.stated->low_db());
    EXPECT_GT(measured_db, 48);

    // Without more rays, few check rays meet the face, and never two in a pixel. The stated interval
    // is accordingly wide.
    s.hybrid.focus.views = 256;
    const HybridResult few = hybrid_picture(focus, s.hybrid);
    ASSERT_TRUE(few.stated);
    EXPECT_LT(few.stated->low_db(), db(few.focus.image, truth));
    EXPECT_GT(few.stated->high_db(), db(few.focus.image, truth));
}

// A light that a post hides from the pinhole is seen through the margin of the lens. It keeps its recorded
// light.
TEST(UnsureViews, ALightBehindAPostKeepsItsRecordedLight) {
    SceneBuilder b;
    b.add(Sphere{dvec3(0, 0, -4), 0.03}, glowing({60, 40, 20}));
    b.add(Rectangle{dvec3(-0.02, -0.1, -1.5), dvec3(0.04, 0, 0), dvec3(0, 0.5, 0)}, glowing({0.1, 0.1, 0.1}));
    add_wall(b);
    const Case c{"", 0.5, 1.2};
    TraceSettings trace = traced_for(c);
    trace.subdivision.levels = 2;
    const TracedFrame frame(b.scene, trace);
    HybridSettings s = hybrid_of(c, 50, 64);
    s.scene = &b.scene;
    const Image got = hybrid_picture(frame.file(), s).focus.image;
    const Image truth = rendered_within(b.scene, by_rays(c, 50, 16384, 9), {24, 0, 16, 40});
    // Measured: 49.2 dB, and 34.4 dB by rays.
    EXPECT_GT(db(got, truth), db(rendered(b.scene, c, 50, 64, 5, true), truth) + 10);
}

// A light is added to the image by its exact response, so rays must not see it again.
TEST(UnsureViews, MeetNoHighlightTwice) {
    SceneBuilder b;
    b.add(Rectangle{dvec3(-0.02, -0.02, -4), dvec3(0.04, 0, 0), dvec3(0, 0.04, 0)}, glowing({60, 40, 20}));
    add_wall(b);
    TraceSettings trace;
    trace.overscan_px = 8;
    trace.subdivision.levels = 4;
    const TracedFrame frame(b.scene, trace);
    const Case c{"", 0.7, 2};
    HybridSettings s = hybrid_of(c, 50, 64);
    const Image recorded = hybrid_picture(frame.file(), s).focus.image;
    s.scene = &b.scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    EXPECT_GT(got.retraced_share, 0);
    const Image truth = rendered_within(b.scene, by_rays(c, 50, 65536, 9), {24, 16, 16, 16});
    EXPECT_GT(db(got.focus.image, truth), db(recorded, truth) - 0.1);
    EXPECT_GT(db(got.focus.image, truth), db(rendered(b.scene, c, 50, 64, 5), truth) + 6);
    double light = 0, right = 0;
    for (const float v : got.focus.image.rgb) light += static_cast<double>(v);
    for (const float v : truth.rgb) right += static_cast<double>(v);
    EXPECT_NEAR(light / right, 1, 0.01);
}

// Rays hit a small light source by chance. The part that the bar hides is recorded, so the impulse response
// can spread all of the light.
TEST(UnsureViews, LeaveALampToTheLensIfItsHiddenPartIsRecorded) {
    SceneBuilder b;
    b.add(Rectangle{dvec3(-0.02, -0.02, -4), dvec3(0.04, 0, 0), dvec3(0, 0.04, 0)}, glowing({60, 40, 20}));
    b.add(Rectangle{dvec3(0.001, -1, -0.7), dvec3(0.04, 0, 0), dvec3(0, 2, 0)}, glowing({0.2, 0.2, 0.2}));
    b.add(Rectangle{dvec3(-90, -90, -10), dvec3(180, 0, 0), dvec3(0, 180, 0)}, glowing({0.2, 0.2, 0.2}));
    b.scene.sha256 = std::string(64, 'd');
    const Case c{"", 0.7, 0.9};
    TraceSettings trace = traced_for(c);
    trace.overscan_px = 8;
    const TracedFrame frame(b.scene, trace);
    HybridSettings s = hybrid_of(c, 50, 64);
    s.scene = &b.scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    EXPECT_GT(got.retraced_share, 0);
    const Image truth = rendered_within(b.scene, by_rays(c, 50, 16384, 9), {24, 0, 16, 48});
    // Measured: 56.5 dB; 42.2 dB if rays replace its highlights, 38.1 dB with rays alone.
    EXPECT_GT(db(got.focus.image, truth), db(rendered(b.scene, c, 50, 64, 5), truth) + 16);
}

// The stated error includes that of highlights. Here a bar beyond the border of the records hides a part of
// the lens from a lamp, so the image shows light that does not arrive. The lamp is so small that rays would
// have more noise.
TEST(UnsureViews, StateTheErrorOfHighlights) {
    SceneBuilder b;
    b.add(Rectangle{dvec3(-1.265, -0.005, -4), dvec3(0.01, 0, 0), dvec3(0, 0.01, 0)},
          glowing({960, 640, 320}));
    b.add(Rectangle{dvec3(-0.6, -1, -0.3), dvec3(0.489, 0, 0), dvec3(0, 2, 0)}, glowing({0.2, 0.2, 0.2}));
    b.add(Rectangle{dvec3(-90, -90, -10), dvec3(180, 0, 0), dvec3(0, 180, 0)}, glowing({0.2, 0.2, 0.2}));
    b.scene.sha256 = std::string(64, 'e');
    const Case c{"", 0.7, 0.9};
    TraceSettings trace;
    trace.subdivision.levels = 4;
    const TracedFrame frame(b.scene, trace);
    HybridSettings s = hybrid_of(c, 50, 256);
    s.scene = &b.scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    const double measured =
        db(got.focus.image, rendered_within(b.scene, by_rays(c, 50, 16384, 9), {0, 0, 16, 48}));
    ASSERT_TRUE(got.stated);
    EXPECT_NEAR(got.stated->db(), measured, 1);
    EXPECT_GT(got.stated->bias_mse, got.stated->views_mse);
}

// Over a wide lens, the images of a lamp in nested glass move otherwise than W says, so the impulse responses
// of the recorded highlights show ghosts. Rays that are aimed at them meet no light, and rays show the lamp.
TEST(UnsureViews, ShowALampWhoseHighlightsAreMisplaced) {
    SceneBuilder b;
    const auto upright = [](double y0, double y1, double radius) {
        return Cone{dvec3(0, y0, -0.8), dvec3(0, y1, -0.8), radius, radius, true};
    };
    b.scene.background = dvec3(0.3);
    b.add(upright(-0.149, 0.1, 0.07), glass(1.5, 0.9));
    b.add(upright(-0.14, 0.04, 0.062), glass(1.33, 0.95));
    b.add(Sphere{dvec3(-0.3, 0.1, -2), 0.02}, glowing({20, 18, 12}));
    b.scene.sha256 = std::string(64, 'f');
    const Case c{"", 1, 0.8};
    TraceSettings trace = traced_for(c);
    trace.overscan_px = 8;
    const TracedFrame frame(b.scene, trace);
    HybridSettings s = hybrid_of(c, 50, 256);
    s.scene = &b.scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    const Image truth = rendered(b.scene, c, 50, 2048, 9);
    // Measured: 46.1 dB, 47.0 dB by as many rays, and 36.7 dB with the highlights.
    EXPECT_GT(db(got.focus.image, truth), db(rendered(b.scene, c, 50, 256, 5, true), truth) - 2);
    // Rays also meet a target that the highlights alone miss.
    FocusFrame again(frame.file(), true);
    const AutoResult to_target = auto_picture(again, {.hybrid = s, .target_db = 42});
    EXPECT_TRUE(to_target.met) << to_target.plan;
    EXPECT_GT(db(to_target.hybrid.focus.image, truth), 42);
}

// Rays that are aimed at a highlight that nothing hides meet its light: in blur wider and narrower than a
// pixel, and through an aperture that is not round.
TEST(UnsureViews, MeetTheHighlightsThatTheyAreAimedAt) {
    SceneBuilder b;
    b.add(Rectangle{dvec3(-0.005, -0.005, -4), dvec3(0.01, 0, 0), dvec3(0, 0.01, 0)}, glowing({12, 8, 4}));
    b.add(Rectangle{dvec3(-90, -90, -10), dvec3(180, 0, 0), dvec3(0, 180, 0)}, glowing({0.2, 0.2, 0.2}));
    b.scene.sha256 = std::string(64, 'c');
    TraceSettings trace;
    trace.overscan_px = 8;
    trace.subdivision.levels = 7;
    const TracedFrame frame(b.scene, trace);
    for (const double focus_m : {1.0, 2.0, 3.9}) {
        for (const char* impulse : {"disc", "polygon:5:10"}) {
            SCOPED_TRACE(fmt::format("{} m, {}", focus_m, impulse));
            HybridSettings s = hybrid_of({"", 0.7, focus_m}, 50, 256);
            s.focus.impulse = parse_impulse("--impulse", impulse);
            s.scene = &b.scene;
            const HybridResult got = hybrid_picture(frame.file(), s);
            ASSERT_TRUE(got.stated);
            EXPECT_GT(got.stated->check_rays, 0);
            EXPECT_LT(got.stated->bias_mse, 1e-6);
        }
    }
}

// Lamps of 0.08 px are only a few records wide, even where the records are closest. Rays measure their area,
// which determines the brightness of their circles of confusion. The rays that are aimed at a round lamp meet
// it wherever they are aimed, so that they state no error. Each lamp shines in one channel.
TEST(UnsureViews, ShowRoundLampsOfAFewRecordsAsBrightAsTheyAre) {
    const std::vector<glm::dvec2> at{{-0.5003, 0.2011}, {0.0112, -0.307}, {0.5207, 0.1133}};
    constexpr double px_per_m = 50 / (36.0 / 64), radius_px = 0.04, radiance = 1000, mirror_m = 2;
    for (const bool in_mirror : {false, true}) {
        SCOPED_TRACE(in_mirror ? "in a mirror" : "seen directly");
        const double depth_m = in_mirror ? 4.5 : 4, radius_m = radius_px / px_per_m * depth_m;
        SceneBuilder b;
        for (glm::length_t c = 0; c < 3; ++c) {
            dvec3 rgb(0);
            rgb[c] = radiance;
            b.add(
                Sphere{dvec3(at[static_cast<std::size_t>(c)], in_mirror ? depth_m - 2 * mirror_m : -depth_m),
                       radius_m},
                glowing(rgb));
        }
        if (in_mirror) b.add(board(-9, 9, -9, 9, mirror_m), mirror());
        b.scene.sha256 = std::string(64, 'a');
        const Case c{"", 0.7, 1};
        TraceSettings trace = traced_for(c);
        trace.overscan_px = 8;
        const TracedFrame frame(b.scene, trace);
        HybridSettings s = hybrid_of(c, 50, 64);
        s.scene = &b.scene;
        const HybridResult got = hybrid_picture(frame.file(), s);
        dvec3 light(0);
        for (std::size_t i = 0; i < got.focus.image.rgb.size(); ++i)
            light[static_cast<glm::length_t>(i % 3)] += static_cast<double>(got.focus.image.rgb[i]);
        for (glm::length_t channel = 0; channel < 3; ++channel) {
            // A sphere beside the axis is seen as an ellipse.
            const double slant =
                             std::hypot(1.0, glm::length(at[static_cast<std::size_t>(channel)]) / depth_m),
                         area = std::numbers::pi * radius_px * radius_px * slant;
            EXPECT_NEAR(light[channel] / (radiance * area), 1, 0.008);
        }
        ASSERT_TRUE(got.stated);
        EXPECT_LT(got.stated->bias_mse, 4e-6);
    }
}

// The variance of the highlights' light tells whether rays can show them. Where rays show them already, none
// of it is left.
TEST(UnsureViews, HaveNoHighlightsWhereRaysShowThem) {
    SceneBuilder b;
    b.add(board(-0.02, 0.02, -0.02, 0.02, 4), glowing({12, 8, 4}));
    b.scene.sha256 = std::string(64, 'b');
    const Case c{"", 0.7, 2};
    const TracedFrame frame(b.scene, traced_for(c));
    FocusFrame light_field(frame.file(), true);
    HybridSettings s = hybrid_of(c, 50, 16);
    s.scene = &b.scene;
    HalvedViews views(light_field, s);
    const std::size_t tiles = views.grid().count();
    views.draw(std::vector<int>(tiles, 16));
    const auto largest = [&] { return *std::ranges::max_element(views.half(0).light_square); };
    EXPECT_GT(largest(), 0);
    EXPECT_TRUE(views.leave_to_rays(std::vector<std::uint8_t>(tiles, 1), LeftToRays::samples_and_lights));
    EXPECT_EQ(largest(), 0);
}

}  // namespace
}  // namespace postlens::test::unsure_views_test
