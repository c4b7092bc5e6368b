// Lights in view samples that become rays: each light is counted once, and small lights have the brightness
// that rays find.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

#include "focus/responses/kernel.h"
#include "planner/auto_picture.h"
#include "planner/hybrid.h"
#include "planner/views/halved_views.h"
#include "tests/planner/lens_case.h"
#include "tests/support/quads.h"
#include "tests/support/reference.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/render.h"

namespace postlens::test::lights_with_rays_test {
namespace {

using glm::dvec3;

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
TEST(LightsWithRays, SmallLightsHaveTheAreaThatRaysMeasure) {
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

// A lamp of radiance 60 lights a dark pixel visibly where it covers a thousandth of it. So the edges of
// almost sharp lamps must be placed to about that precision, and their blur (here with a radius of 0.1 px)
// must cross the borders of pixels. With kernels and records that are rounded to 1/32 px, the PSNR was 40.9
// dB.
TEST(LightsWithRays, AlmostSharpLampsLightTheRightPixels) {
    SceneBuilder b;
    for (int i = 0; i < 12; ++i) {
        const double x = 0.3 * (i % 6 - 2.5) + 0.0093 * i, y = 0.4 * (i / 6 - 0.5) + 0.0071 * i;
        b.add(Rectangle{dvec3(x, y, -4), dvec3(0.065 + 0.003 * i, 0, 0), dvec3(0, 0.09, 0)},
              glowing({60, 40, 20}));
    }
    add_wall(b);
    const Case c{"", 1.4, 5.5};
    const TracedFrame frame(b.scene, traced_for(c));
    HybridSettings s = hybrid_of(c, 50, 64);
    s.scene = &b.scene;
    const HybridResult got = hybrid_picture(frame.file(), s);
    const Reference truth = reference(b.scene, by_rays(c, 50, 4096, 9));
    const double of_rays = encoded_psnr(rendered(b.scene, c, 50, 64, 5, true), truth),
                 psnr_db = encoded_psnr(got.focus.image, truth);
    EXPECT_GT(psnr_db, of_rays + 10);
    ASSERT_TRUE(got.stated);
    EXPECT_GT(psnr_db, got.stated->low_db());
}

// Posts in front of lamps of radiance 100 may hide them from a part of the lens, so blur kernels do not
// spread their light. Pixels at their edges get more rays instead.
TEST(LightsWithRays, EdgesOfPartlyHiddenLampsGetMoreRays) {
    SceneBuilder b;
    for (int i = 0; i < 8; ++i) {
        const double x = 0.3 * (i % 4 - 1.5) + 0.0093 * i, y = 0.5 * (i / 4 - 0.5) + 0.0071 * i;
        b.add(Rectangle{dvec3(x, y, -4), dvec3(0.1, 0, 0), dvec3(0, 0.09, 0)}, glowing({100, 60, 30}));
        b.add(Rectangle{dvec3(0.8 * x + 0.05, 0.8 * y - 0.05, -3.2), dvec3(0.1, 0, 0), dvec3(0, 0.2, 0)},
              glowing({0.1, 0.1, 0.1}));
    }
    add_wall(b);
    const Case c{"", 1.4, 5.5};
    const TracedFrame frame(b.scene, traced_for(c));
    HybridSettings s = hybrid_of(c, 50, 64);
    s.scene = &b.scene;
    const Reference truth = reference(b.scene, by_rays(c, 50, 4096, 9));
    double gain_db = 0;  // mean over independent images
    for (const int views : {48, 64, 80, 96}) {
        s.focus.views = views;
        gain_db += (encoded_psnr(hybrid_picture(frame.file(), s).focus.image, truth) -
                    encoded_psnr(rendered(b.scene, c, 50, views, 5, true), truth)) /
                   4;
    }
    // Measured: 4.5 dB, and 2.2 dB without the additional rays.
    EXPECT_GT(gain_db, 4);
}

// A bright face whose plane almost meets the rim of the lens shows one side of the lens about nine times the
// area that it shows the other. This displaces its light by a fifth of the CoC radius of 3.3 px.
TEST(LightsWithRays, AFaceSeenEdgeOnShinesMoreOnOneSideOfTheLens) {
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
TEST(LightsWithRays, AFaceWhosePlaneCutsTheLensIsLeftToRays) {
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
TEST(LightsWithRays, ALightBehindAPostKeepsItsRecordedLight) {
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
TEST(LightsWithRays, MeetNoHighlightTwice) {
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
TEST(LightsWithRays, LeaveALampToTheLensIfItsHiddenPartIsRecorded) {
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
TEST(LightsWithRays, StateTheErrorOfHighlights) {
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
TEST(LightsWithRays, ShowALampWhoseHighlightsAreMisplaced) {
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
    const Reference truth = reference(b.scene, by_rays(c, 50, 512, 9));
    // Measured: 46.1 dB, 47.0 dB by as many rays, and 36.7 dB with the highlights.
    EXPECT_GT(encoded_psnr(got.focus.image, truth),
              encoded_psnr(rendered(b.scene, c, 50, 256, 5, true), truth) - 2);
    // Rays also meet a target that the highlights alone miss.
    FocusFrame again(frame.file(), true);
    const AutoResult to_target = auto_picture(again, {.hybrid = s, .target_db = 42});
    EXPECT_TRUE(to_target.met) << to_target.plan;
    EXPECT_GT(encoded_psnr(to_target.hybrid.focus.image, truth), 42);
}

// Rays that are aimed at a highlight that nothing hides meet its light: in blur wider and narrower than a
// pixel, and through an aperture that is not round.
TEST(LightsWithRays, MeetTheHighlightsThatTheyAreAimedAt) {
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
TEST(LightsWithRays, ShowRoundLampsOfAFewRecordsAsBrightAsTheyAre) {
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

// The corners of the records meet a ring of light only in places, because it is narrower than a pixel when
// seen nearly edge-on. Rays follow it from there.
TEST(LightsWithRays, ShowAllLightOfARingThatRecordsMeetInPlaces) {
    constexpr double px_per_tangent = 35 / (36.0 / 160), radiance = 600;
    const Disc ring{dvec3(0.1674, 0.2443, -1.4365), glm::normalize(dvec3(0.7726, -0.6316, 0.0649)), 0.0782,
                    0.0758};
    SceneBuilder b;
    b.scene.cameras[0].focal_length_mm = 35;
    b.scene.cameras[0].width = 160;
    b.scene.cameras[0].height = 90;
    b.add(ring, glowing(dvec3(radiance)));
    b.scene.sha256 = std::string(64, 'a');
    const Case c{"", 4, 3};
    const TracedFrame frame(b.scene, traced_for(c));
    HybridSettings s = hybrid_of(c, 35, 16);
    s.scene = &b.scene;
    const Image image = hybrid_picture(frame.file(), s).focus.image;
    double light = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) light += static_cast<double>(image.rgb[i]);
    // A small area A with the normal n at the point p, at the depth z, has the image A |n . p| / z^3, in
    // tangents squared.
    const double area =
                     std::numbers::pi * (ring.radius * ring.radius - ring.inner_radius * ring.inner_radius),
                 depth = -ring.centre.z,
                 area_px2 = area * std::abs(glm::dot(ring.normal, ring.centre)) * px_per_tangent *
                            px_per_tangent / (depth * depth * depth);
    // About 64 x 64 x 1.1 px^2 rays hit the ring, whose count is known to 1.5 %. Depths differ by 5 % around
    // the ring's centre, so the mean of 1 / z^3 is 1 % larger than there.
    EXPECT_NEAR(light / (radiance * area_px2), 1.01, 0.045);
}

// Light of a wide surface continues beyond the recorded pixels. Rays must not follow it without end.
TEST(LightsWithRays, MeasureTheEdgeOfABrightFloorWithFewRays) {
    SceneBuilder b;
    b.add(Plane{dvec3(0, -0.7, 0), dvec3(0, 1, 0)}, glowing({4, 6, 4}));
    b.scene.sha256 = std::string(64, 'a');
    b.scene.cameras[0].width = 240;
    b.scene.cameras[0].height = 136;
    const Case c{"", 0.7, 1.6};
    TraceSettings trace = traced_for(c);
    trace.subdivision.levels = 1;
    const TracedFrame frame(b.scene, trace);
    HybridSettings s = hybrid_of(c, 50, 2);
    s.scene = &b.scene;
    const HybridResult result = hybrid_picture(frame.file(), s);
    // The edges get as many rays as 4096 pixels with 16 x 16 rays each, and each pixel gets at most two rays
    // as view samples and two as checks.
    EXPECT_LT(result.rays.eye, 4096U * 256 + 4 * 240 * 136);
}

// Image of 64 x 48 px of a square light of side `side_px`, blurred by a disc: the part of its light in each
// pixel. Its upper left corner is `from_px` right of and below the centre of the image.
std::vector<double> blurred_square(double from_px, double side_px, double blur_px) {
    constexpr int points = 64;
    std::vector<double> out(std::size_t{64} * 48);
    for (int i = 0; i < points * points; ++i) {
        const glm::dvec2 at = from_px + side_px / points * glm::dvec2(i % points + 0.5, i / points + 0.5),
                         whole = glm::floor(at);
        const Kernel kernel = make_kernel(Ellipse::disc(blur_px), at.x - whole.x, at.y - whole.y, {32, 24});
        for (std::size_t row = 0; row < kernel.rows.size(); ++row) {
            const std::size_t y =
                static_cast<std::size_t>(24 + static_cast<int>(whole.y) + kernel.y_begin) + row;
            for (int x = kernel.rows[row].x_begin; x < kernel.rows[row].x_end; ++x)
                out[y * 64 + static_cast<std::size_t>(32 + static_cast<int>(whole.x) + x)] +=
                    kernel.at(kernel.rows[row], x) / (points * points);
        }
    }
    return out;
}

// Traces a square lamp, blurs it, and returns the largest error of a pixel. The arguments are those of
// blurred_square.
double largest_error_of_lamp(double from_px, double side_px, double blur_px, double radiance, double f_number,
                             int views) {
    constexpr double px_per_m = 50 / (36.0 / 64), depth_m = 4;
    const double from_m = from_px / px_per_m * depth_m, end_m = (from_px + side_px) / px_per_m * depth_m;
    SceneBuilder b;
    b.add(board(from_m, end_m, -end_m, -from_m, depth_m), glowing(dvec3(radiance)));
    b.scene.sha256 = std::string(64, 'a');
    const double lens_radius_m = 0.05 / f_number / 2;
    const Case c{"", f_number, 1 / (blur_px / (px_per_m * lens_radius_m) + 1 / depth_m)};
    const TracedFrame frame(b.scene, traced_for(c));
    HybridSettings s = hybrid_of(c, 50, views);
    s.scene = &b.scene;
    const Image got = hybrid_picture(frame.file(), s).focus.image;
    const std::vector<double> expected = blurred_square(from_px, side_px, blur_px);
    const double light = radiance * side_px * side_px;
    double largest = 0;
    for (std::size_t k = 0; k < expected.size(); ++k)
        largest = std::max(largest, std::abs(static_cast<double>(got.rgb[3 * k]) - light * expected[k]));
    return largest;
}

// The rim of a highlight's circle of confusion shows how wide the highlight is. If all light of half a pixel
// were spread from one point, the rim would be too sharp.
TEST(LightsWithRays, SpreadALampFromAllOfItsArea) {
    constexpr double side_px = 0.5, blur_px = 5.75, radiance = 4000,
                     in_disc = radiance * side_px * side_px / (std::numbers::pi * blur_px * blur_px);
    // The lamp has the centre (32.25, 24.25) px, so that the rim for its centre just reaches column 38.
    //
    // The radius of the disc is right to 1/128 px. Light is displaced by up to 1/16 px, and by 1/64 px on the
    // mean of those squares of 1/8 px that it moves away from a pixel. One of 64 views may show radiance
    // of 1.
    EXPECT_LT(largest_error_of_lamp(0, side_px, blur_px, radiance, 0.7, 64),
              in_disc * (1.0 / 128 + 1.0 / 64) + 1.0 / 64);
}

// The edges of a sharp lamp, blurred by 0.3 px, cover a small part of some pixels. The image must have the
// right light in each of them.
TEST(LightsWithRays, KeepTheShapeOfASharpLamp) {
    constexpr double radiance = 20;
    // Rays measure the area of the lamp to about 0.007 px^2. Measured: 0.013; with squares of 1/8 px that
    // do not end at pixel borders 0.22.
    EXPECT_LT(largest_error_of_lamp(0.3, 0.84, 0.3, radiance, 8, 256), 0.007 * radiance);
}

// A post covers the left 40 % of a pixel, and a lamp a part of the rest. The post hides nothing of the lamp,
// although many views see the post in this pixel.
TEST(LightsWithRays, ShowAllOfASharpLampBesideAPost) {
    constexpr double px_per_m = 50 / (36.0 / 64), f_number = 16;
    const auto at = [](double px, double depth_m) { return px / px_per_m * depth_m; };
    SceneBuilder b;
    b.add(board(at(0.6, 4.4), at(1.4, 4.4), at(-0.9, 4.4), at(-0.2, 4.4), 4.4), glowing(dvec3(20)));
    b.add(board(at(-1.6, 4), at(0.4, 4), at(-3, 4), at(3, 4), 4), glowing(dvec3(0.01)));
    add_wall(b);
    const Case c{"", f_number, 4.2};
    const TracedFrame frame(b.scene, traced_for(c));
    HybridSettings s = hybrid_of(c, 50, 256);
    s.scene = &b.scene;
    const Image got = hybrid_picture(frame.file(), s).focus.image;
    const Image truth = rendered_within(b.scene, by_rays(c, 50, 16384, 9), {29, 19, 6, 10});
    EXPECT_NEAR(static_cast<double>(got.pixel(32, 24)[0]), static_cast<double>(truth.pixel(32, 24)[0]), 0.15);
}

// The variance of the highlights' light tells whether rays can show them. Where rays show them already, none
// of it is left.
TEST(LightsWithRays, HaveNoHighlightsWhereRaysShowThem) {
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

// Many views see light where it fills its blur. Impulse responses spread only the small light.
TEST(LightsWithRays, ShowBrightLightThatFillsItsBlur) {
    SceneBuilder b;
    b.add(board(-9, 0, -9, 9, 4), glowing({12, 8, 4}));
    b.add(board(0.98, 1.02, -0.02, 0.02, 4), glowing({12, 8, 4}));
    b.scene.sha256 = std::string(64, 'b');
    b.scene.cameras[0].width = 240;
    b.scene.cameras[0].height = 64;
    const Case c{"", 1.4, 1};
    const TracedFrame frame(b.scene, traced_for(c));
    FocusFrame light_field(frame.file(), true);
    HybridSettings s = hybrid_of(c, 50, 2);
    s.scene = &b.scene;
    HalvedViews views(light_field, s);
    views.draw(std::vector<int>(views.grid().count(), 2));
    const std::vector<float>& light = views.half(0).light_square;
    ASSERT_FALSE(light.empty());
    const auto at = [&](int x) { return light[static_cast<std::size_t>(240 * 32 + x)]; };
    EXPECT_EQ(at(60), 0);
    EXPECT_GT(at(203), 0);
}

}  // namespace
}  // namespace postlens::test::lights_with_rays_test
