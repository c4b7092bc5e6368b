// The light field over the lens, compared with closed forms, and with rays where surfaces occlude each other.
#include "focus/light_field/field_focus.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "core/error.h"
#include "core/threads.h"
#include "focus/focus.h"
#include "pictures/aperture_file.h"
#include "pictures/crop.h"
#include "tests/support/motion_frame.h"
#include "tests/support/reference.h"
#include "tracer/render.h"

namespace postlens::test::field_focus_test {
namespace {

using glm::dvec3;

/// Displacement of an image point by the rim of the lens, px per 1/m of defocus.
double rim_px(const ThinLens& lens) {
    return px_per_m * lens.focal_length_mm * 1e-3 / (2 * lens.f_number);
}

// Five levels locate borders to 1/64 px. Images of 64 px have many borders, whose records limit the accuracy.
// The overscan must exceed the largest radius of a CoC.
TraceSettings for_lens(double f_number, int levels = 5, int overscan_px = 8) {
    TraceSettings s;
    s.subdivision.levels = levels;
    s.for_f_number = f_number;
    s.hidden_layers = 3;
    s.overscan_px = overscan_px;
    return s;
}

RenderSettings by_rays(const FocusSettings& f, int spp) {
    RenderSettings s;
    s.focal_length_mm = f.lens.focal_length_mm;
    s.f_number = f.lens.f_number;
    s.focus_m = f.focus_distance_m;
    s.aperture = std::make_shared<Aperture>(read_aperture(f.impulse));
    s.spp = spp;
    return s;
}

Reference rays(const Scene& scene, const FocusSettings& f, int spp = 256) {
    return reference(scene, by_rays(f, spp));
}

double sum(const Image& image) {
    double out = 0;
    for (const float v : image.rgb) out += static_cast<double>(v);
    return out;
}

double largest_difference(const Image& a, const Image& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i])));
    return worst;
}

/// A near bar, a sphere, a tilted bright board and a far wall.
SceneBuilder layered() {
    SceneBuilder b;
    b.add(board(-0.10, 0.02, -2, 2, 0.9), glowing({0.9, 0.2, 0.1}));
    b.add(Sphere{{0.25, 0.05, -2}, 0.3}, glowing({0.1, 0.7, 0.2}));
    b.add(Rectangle{dvec3(-1.2, -0.8, -3), dvec3(0.9, 0, 0.5), dvec3(0, 0.9, -0.6)},
          glowing({0.8, 0.8, 0.2}));
    for (int i = -8; i < 8; ++i) b.add(board(i * 0.7, i * 0.7 + 0.35, -9, 9, 9.9), glowing({0.9, 0.9, 0.9}));
    b.add(board(-20, 20, -20, 20, 10), glowing({0.15, 0.2, 0.4}));
    return b;
}

constexpr ThinLens wide{.focal_length_mm = 50, .f_number = 0.7};

FocusSettings by_field(double focus_m, int views = 512) {
    return {.lens = wide, .focus_distance_m = focus_m, .method = FocusMethod::lightfield, .views = views};
}

// The blurred edge at 0, averaged over a pixel with its centre at `at`: the integral of the edge profile of a
// disc of radius r.
double edge(double at, double r) {
    const auto integral = [r](double x) {  // of 1/2 + (t sqrt(1 - t^2) + asin t)/pi, t = x / r
        if (x <= -r) return 0.0;
        if (x >= r) return x;
        const double t = x / r, root = std::sqrt(1 - t * t);
        return r * (t / 2 + (-root * root * root / 3 + t * std::asin(t) + root) / std::numbers::pi);
    };
    return integral(at + 0.5) - integral(at - 0.5);
}

// The blur of the uniform background has no effect. Corners locate the border to 1/128 px, half of the finest
// leaf's half, which changes the light by at most 2/(pi r) of the step per px. The error of the views is
// below one of 32 that lie along the edge's chord, of 1024.
TEST(FieldFocus, AHalfPlaneBeforeAnEvenBackgroundIsTheEdgeOfADisc) {
    for (const double focus_m : {10.0, 3.0}) {
        SceneBuilder b;
        b.add(board(-9, 0, -9, 9, 0.8), glowing({1, 1, 1}));
        b.add(board(-90, 90, -90, 90, 10), glowing({0.25, 0.25, 0.25}));
        const TracedFrame frame(b.scene, for_lens(wide.f_number));
        const FocusResult got = focus_picture(frame.file(), by_field(focus_m, 1024));
        const double r = rim_px(wide) * std::abs(1 / focus_m - 1 / 0.8);
        EXPECT_GT(r, 2.5);
        for (int x = 0; x < 64; ++x) {
            const double near = edge(32 - (x + 0.5), r), expected = 0.25 + 0.75 * near;
            EXPECT_NEAR(static_cast<double>(got.image.pixel(x, 24)[1]), expected,
                        0.75 * (2 / (std::numbers::pi * r) / 128 + 1.0 / 32))
                << x << ", focus " << focus_m;
        }
        EXPECT_TRUE(got.warnings.empty());
    }
}

// 512 views have an error of 0.5/sqrt(512)/3 at an edge of this contrast, which is 43 dB near edges, in a
// third of the image. The noise of the rays, 46 to 53 dB, is subtracted. Measured: 49.7 dB or better.
TEST(FieldFocus, ShowsWhatIsHiddenAsRaysDo) {
    const SceneBuilder b = layered();
    const TracedFrame traced(b.scene, for_lens(wide.f_number));
    FocusFrame frame(traced.file(), true);
    for (const double focus_m : {0.9, 2.0, 9.9}) {
        const FocusSettings f = by_field(focus_m);
        const Reference truth = rays(b.scene, f);
        const FocusResult got = focus_picture(frame, f);
        FocusSettings flat = f;
        flat.method = FocusMethod::scatter;
        EXPECT_GT(psnr(got.image, truth), 46) << focus_m;
        EXPECT_GT(psnr(got.image, truth), psnr(focus_picture(frame, flat).image, truth) + 6) << focus_m;
        EXPECT_NEAR(sum(got.image) / sum(truth.image), 1, 3e-3) << focus_m;
        EXPECT_TRUE(got.warnings.empty()) << focus_m;
        EXPECT_EQ(got.views, 512);
        EXPECT_EQ(got.method, FocusMethod::lightfield);
    }
}

TEST(FieldFocus, SaysWhatWasNotRecorded) {
    TraceSettings visible = for_lens(wide.f_number);
    visible.hidden_layers = 0;
    const SceneBuilder b = layered();
    const TracedFrame frame(b.scene, visible);
    const FocusResult got = focus_picture(frame.file(), by_field(9.9));
    ASSERT_EQ(got.warnings.size(), 1);
    EXPECT_EQ(got.warnings[0].code, "uncovered");
    EXPECT_GT(got.warnings[0].share, 0.003);
    EXPECT_LT(got.warnings[0].share, 0.3);
}

// For a single plane through the focus nothing is hidden, so the scatter method is exact.
TEST(FieldFocus, ASlantedPlaneIsWhatScatteringMakesOfIt) {
    SceneBuilder b;
    for (int i = 0; i < 40; ++i) {
        // The plane is tilted by 45 degrees, from 1 m below the axis at a distance of 1 m to above the axis.
        const double z = 1 + 0.1 * i;
        b.add(Rectangle{dvec3(-9, z - 2, -z), dvec3(18, 0, 0), dvec3(0, 0.1, -0.1)},
              glowing(i % 2 == 0 ? dvec3(0.8, 0.4, 0.2) : dvec3(0.2, 0.3, 0.5)));
    }
    const TracedFrame frame(b.scene, for_lens(wide.f_number));
    FocusSettings f = by_field(2, 1024);
    const Image field = focus_picture(frame.file(), f).image;
    const Reference truth = rays(b.scene, f);
    f.method = FocusMethod::scatter;
    EXPECT_GT(psnr(field, truth), 44);
    EXPECT_GT(psnr(field, focus_picture(frame.file(), f).image), 40);
}

TEST(FieldFocus, TakesAnyApertureThatRaysHavePointsOf) {
    const SceneBuilder b = layered();
    const TracedFrame traced(b.scene, for_lens(wide.f_number));
    FocusFrame frame(traced.file(), true);
    const Reference by_a_disc = rays(b.scene, by_field(2));
    for (const Impulse& impulse :
         {Impulse{.kind = ImpulseKind::polygon, .blades = 3, .rotation_deg = 20}, Impulse{.squeeze = 2},
          Impulse{.cats_eye = 0.9}, Impulse{.spherical = 0.3}}) {
        FocusSettings f = by_field(2);
        f.impulse = impulse;
        const Image got = focus_picture(frame, f).image;
        EXPECT_GT(psnr(got, rays(b.scene, f)), 45) << impulse_text(impulse);
        EXPECT_LT(psnr(got, by_a_disc), 37) << impulse_text(impulse);  // a wrong aperture is detected
    }
}

TEST(FieldFocus, RefusesWhatHasNoPointsOfALens) {
    const SceneBuilder b = layered();
    const TracedFrame frame(b.scene, for_lens(wide.f_number, 0));
    FocusSettings f = by_field(2);
    f.impulse.kind = ImpulseKind::diffraction;
    EXPECT_THROW((void)focus_picture(frame.file(), f), Error);
    f = by_field(2, 0);
    EXPECT_THROW((void)focus_picture(frame.file(), f), Error);
    f = by_field(2);
    f.depth_model = DepthModel::path;
    EXPECT_THROW((void)focus_picture(frame.file(), f), Error);
}

/// A light source in the middle of the image at 4 m, in front of a uniform wall.
SceneBuilder lamp_before(double wall) {
    SceneBuilder b;
    b.add(board(-0.02, 0.02, -0.02, 0.02, 4), glowing({60, 40, 20}));
    b.add(board(-90, 90, -90, 90, 10), glowing(dvec3(wall)));
    return b;
}

// The radiance above 1 of a light is removed from the sheets and added as its response. Sum and centre must
// be right, and the disc uniform, with as few as 16 views.
TEST(FieldFocus, AHighlightIsOneDiscForAnyNumberOfViews) {
    const SceneBuilder b = lamp_before(0.2);
    const TracedFrame frame(b.scene, for_lens(wide.f_number));
    const Image pinhole = pinhole_picture(frame.file());
    FocusSettings f = by_field(0.9, 1024);
    const Image many = focus_picture(frame.file(), f).image;
    f.views = 16;
    const Image few = focus_picture(frame.file(), f).image;
    EXPECT_NEAR(sum(few) / sum(pinhole), 1, 1e-3);
    EXPECT_NEAR(sum(many) / sum(pinhole), 1, 1e-3);
    // Each of 16 views sees the light's remaining radiance of 1 in the sheets, or does not.
    EXPECT_LT(largest_difference(few, many), (1 - 0.2) * 2 / 16);
    const double r = rim_px(wide) * (1 / 0.9 - 1 / 4.0);
    // Expected value of the brightest channel above the background: the light's area over that of the disc.
    const double side_px = 0.04 / 4 * px_per_m,
                 expected = 60 * side_px * side_px / (std::numbers::pi * r * r);
    EXPECT_NEAR(static_cast<double>(few.pixel(32, 24)[0]), expected + 0.2,
                0.05 * expected + (1 - 0.2) * 2 / 16);
    double weight = 0, x_mean = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            const double v = static_cast<double>(few.pixel(x, y)[0]) - 0.2;
            weight += v;
            x_mean += v * (x + 0.5);
        }
    }
    EXPECT_NEAR(x_mean / weight, 32, 0.05);
}

// Views show light of less than twice the radiance of white, so its image is proportional to its radiance.
TEST(FieldFocus, OnlyLightTwiceAsBrightAsWhiteIsAHighlight) {
    const auto picture = [](float radiance) {
        SceneBuilder b;
        b.add(board(-0.2, 0.2, -0.2, 0.2, 4), glowing({radiance, radiance / 2, 0}));
        const TracedFrame frame(b.scene, for_lens(wide.f_number));
        return focus_picture(frame.file(), by_field(0.9, 16)).image;
    };
    const Image white = picture(1);
    const auto difference = [&](float radiance) {
        Image expected = white;
        for (float& v : expected.rgb) v *= radiance;
        return largest_difference(picture(radiance), expected);
    };
    EXPECT_LT(difference(1.99F), 1e-5);
    // The views' steps of 1/16 disappear from the half of the light that is spread.
    EXPECT_GT(difference(2.01F), 0.5 / 16);
}

// A disc that is 10 % too wide is 20 % too dark, which only a light source shows.
TEST(FieldFocus, SmallDiscsAreAsBrightAsTheyAreNarrow) {
    const SceneBuilder b = lamp_before(0);
    const TracedFrame frame(b.scene, for_lens(wide.f_number, 5, 12));
    // The first channel is half of the sum of 60, 40 and 20.
    const double light = sum(pinhole_picture(frame.file())) / 2;
    for (const double r : {2.13, 2.38, 2.63, 2.88, 3.4, 4.6, 5.9, 7.7, 11.3}) {
        for (const FocusMethod method :
             {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
            FocusSettings f = by_field(1 / (r / rim_px(wide) + 1 / 4.0), 1024);
            f.method = method;
            const Image picture = focus_picture(frame.file(), f).image;
            // The radius of a disc is accurate to 1 % or 1/32 px, and its brightness to twice that. Views see
            // the 60th part of the light that is not above 1.
            const double expected = light / (std::numbers::pi * r * r);
            EXPECT_NEAR(static_cast<double>(picture.pixel(32, 24)[0]) / expected, 1,
                        2 * std::max(0.0101, 1.0 / 32 / r) + 0.005)
                << r << " " << static_cast<int>(method);
        }
    }
}

/// The columns that the border of a half-plane or of a post in the middle of the image is blurred over.
constexpr Crop middle_columns{24, 0, 16, 48};

TEST(FieldFocus, AHighlightIsCutByWhatStandsBeforeIt) {
    SceneBuilder b;
    b.add(board(-0.02, 0.02, -0.02, 0.02, 4), glowing({60, 40, 20}));
    b.add(board(-3, 0.004, -3, 3, 0.6), glowing({0.1, 0.1, 0.1}));
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    const TracedFrame frame(b.scene, for_lens(wide.f_number));
    const FocusSettings f = by_field(1, 64);
    const Image truth = rendered_within(b.scene, by_rays(f, 4096), middle_columns),
                got = focus_picture(frame.file(), f).image;
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.02);
    EXPECT_GT(psnr(got, truth), 36);
}

// A light source several pixels wide consists of many lights whose shadows have different positions. Shadows
// of bars behind the focus move twice as far as the lights; their edges must be soft, without steps.
TEST(FieldFocus, AWideLampsShadowsAreSoft) {
    SceneBuilder b;
    b.add(board(-0.4, 0.4, -0.4, 0.4, 12), glowing({15, 15, 15}));
    b.add(board(-5, 0.02, -5, 5, 2.5), glowing({0.1, 0.1, 0.1}));
    b.add(board(-90, 90, -90, 90, 20), glowing({0.1, 0.1, 0.1}));
    const TracedFrame frame(b.scene, for_lens(wide.f_number));
    const FocusSettings f = by_field(0.6, 256);
    const Image truth = rendered_within(b.scene, by_rays(f, 16384), {16, 8, 32, 32}),
                got = focus_picture(frame.file(), f).image;
    // Measured: 36.7 dB. If all lights of a group cast the shadow of its centre: 27.3 dB.
    EXPECT_GT(psnr(got, truth), 35);
}

// Each pixel sees only a part of a bright surface that is wider than its blur. If its highlights were spread,
// all highlights within 1.5 px would share one shadow of a nearer surface, and shine through its border.
TEST(FieldFocus, AWideBrightSurfaceDoesNotShineThroughWhatHidesAPart) {
    SceneBuilder b;
    b.add(board(-0.1, 0.15, -0.15, 0.15, 1.5), glowing({3, 3, 3}));
    b.add(board(-0.8, 0.02, -0.8, 0.02, 1), glowing({0.1, 0.1, 0.1}));
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    FocusSettings f = by_field(5, 256);
    f.lens.f_number = 0.35;
    const TracedFrame frame(b.scene, for_lens(f.lens.f_number));
    const Image truth = render_picture(b.scene, by_rays(f, 4096)).image,
                got = focus_picture(frame.file(), f).image;
    // Measured: 42.4 dB, and 42.8 dB by rays; 40.2 dB if its highlights are spread.
    EXPECT_GT(psnr(got, truth), psnr(render_picture(b.scene, by_rays(f, f.views)).image, truth) - 1);
}

// The blur of a light of a pixel is hardly wider than a pixel. A pixel at its border receives the light
// through one side of the lens, and a post beside the light hides another side.
TEST(FieldFocus, APostBesideASharpLightDoesNotDarkenIt) {
    SceneBuilder b;
    b.add(board(0, 0.1, -0.05, 0.05, 8), glowing({20, 20, 20}));
    b.add(board(-0.3, -0.01, -3, 3, 7), glowing({0.1, 0.1, 0.1}));
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    const TracedFrame frame(b.scene, for_lens(wide.f_number));
    const FocusSettings f = by_field(2.2, 256);
    const Image truth = rendered_within(b.scene, by_rays(f, 16384), middle_columns),
                got = focus_picture(frame.file(), f).image;
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.01);
    // Measured: 52.4 dB; 27.2 dB if all views decide on the light of every pixel.
    EXPECT_GT(psnr(got, truth), 48);
}

// The light reaches each pixel of the disc through a different lens point, so occluders must be found for
// this point and not for the eight nearest views. A post cuts a third out of the disc, with edges a pixel
// wide.
TEST(FieldFocus, FewViewsCutAHighlightAsSharplyAsRays) {
    SceneBuilder b;
    b.add(board(-0.02, 0.02, -0.02, 0.02, 4), glowing({60, 40, 20}));
    b.add(board(-0.006, 0.004, -3, 3, 0.6), glowing({0.1, 0.1, 0.1}));
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    const TracedFrame frame(b.scene, for_lens(wide.f_number));
    const FocusSettings f = by_field(1, 8);
    const Image truth = rendered_within(b.scene, by_rays(f, 4096), middle_columns),
                got = focus_picture(frame.file(), f).image;
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.02);
    // With occlusion from the views nearest to each point it would be 35.4 dB.
    EXPECT_GT(psnr(got, truth), 37.5);
}

TEST(FieldFocus, SameBitsOnAnyThreads) {
    const SceneBuilder b = layered();
    const TracedFrame frame(b.scene, for_lens(wide.f_number, 2));
    const auto with = [&](int threads) {
        const ThreadLimit limit(threads);
        return focus_picture(frame.file(), by_field(2, 32)).image.rgb;
    };
    EXPECT_EQ(with(1), with(3));
}

// From f/0.5 to f/64 and from 0.1 m to infinity, all values are finite, not negative and at most the
// brightest colour.
TEST(FieldFocus, StaysWithinItsColoursForAnyLens) {
    const SceneBuilder b = layered();
    const TracedFrame frame(b.scene, for_lens(0.5, 1, 24));
    for (const double n : {0.5, 2.8, 64.0}) {
        for (const double focus_m : {0.1, 1.0, std::numeric_limits<double>::infinity()}) {
            for (const double focal_length_mm : {50.0, 400.0}) {  // CoC of up to four image widths
                FocusSettings f = by_field(focus_m, 16);
                f.lens = {.focal_length_mm = focal_length_mm, .f_number = n};
                for (const float v : focus_picture(frame.file(), f).image.rgb) {
                    ASSERT_TRUE(std::isfinite(v)) << n << ' ' << focus_m;
                    ASSERT_GE(v, 0) << n << ' ' << focus_m;
                    ASSERT_LE(v, 0.9001F) << n << ' ' << focus_m;
                }
            }
        }
    }
}

// A vanishing aperture gives the pinhole image: exactly in pixels that are not subdivided, and sampled at one
// position per view in the others.
TEST(FieldFocus, AVanishingLensIsThePinhole) {
    const SceneBuilder b = layered();
    const TracedFrame frame(b.scene, for_lens(wide.f_number, 0));
    FocusSettings f = by_field(2, 16);
    f.lens.f_number = 1e7;
    const Image pinhole = pinhole_picture(frame.file()), got = focus_picture(frame.file(), f).image;
    // In a pixel whose corners see several objects, each corner counts for a quarter, sampled at 16
    // positions.
    EXPECT_LT(largest_difference(got, pinhole), 0.9 * 2 / 16 + 1e-6);
    EXPECT_GT(psnr(got, pinhole), 38);
}

// Mirrors and glass ------------------------------------------------------------------------------------

/// Boards at several depths behind the camera that are seen in `shape`, with walls around.
SceneBuilder seen_in(const Shape& shape, const Material& material) {
    SceneBuilder b;
    b.add(shape, material);
    // The boards are wide enough to be hit by corners of pixels, in a ball as well.
    for (int i = -3; i < 3; ++i) {
        b.add(Rectangle{dvec3(i * 2.0 + 0.3, -4, 3), dvec3(1, 0, 0), dvec3(0, 8, 0)},
              glowing({0.8, 0.6, 0.3}));
        b.add(board(i * 1.0 + 0.2, i * 1.0 + 0.7, -9, 9, 5.9), glowing({0.2, 0.5, 0.8}));
    }
    b.add(Rectangle{dvec3(-20, -20, 3.2), dvec3(40, 0, 0), dvec3(0, 40, 0)}, glowing({0.2, 0.1, 0.3}));
    b.add(board(-20, 20, -20, 20, 6), glowing({0.3, 0.3, 0.1}));
    return b;
}

/// PSNR over the middle of the image, which shows the mirror.
double psnr_inside(const Image& image, const Reference& truth, int half_px) {
    const Crop middle{32 - half_px, 24 - half_px, 2 * half_px, 2 * half_px};
    return psnr(cut(image, middle), {{}, {cut(truth.halves[0], middle), cut(truth.halves[1], middle)}});
}

TEST(FieldFocus, WhatAFlatMirrorShowsHasItsOwnDepth) {
    const SceneBuilder b = seen_in(board(-0.45, 0.45, -0.35, 0.35, 2), mirror(0.9));
    const TracedFrame traced(b.scene, for_lens(wide.f_number));
    FocusFrame frame(traced.file(), true);
    for (const double focus_m : {2.0, 5.0, 7.0}) {
        const FocusSettings f = by_field(focus_m);
        const Reference truth = rays(b.scene, f);
        const Image got = focus_picture(frame, f).image;
        EXPECT_GT(psnr_inside(got, truth, 10), 48) << focus_m;
        EXPECT_GT(psnr(got, truth), 48) << focus_m;
    }
}

TEST(FieldFocus, WhatASphereShowsHasItsOwnDepth) {
    for (const Material& m : {mirror(0.9), glass(1.3, 0.9)}) {
        const SceneBuilder b = seen_in(Sphere{{0, 0, -2.5}, 0.6}, m);
        const TracedFrame traced(b.scene, for_lens(1.4, 4));
        FocusFrame frame(traced.file(), true);
        for (const double focus_m : {2.0, 6.0}) {
            FocusSettings f = by_field(focus_m);
            f.lens.f_number = 1.4;
            const Reference truth = rays(b.scene, f);
            const Image got = focus_picture(frame, f).image;
            EXPECT_GT(psnr_inside(got, truth, 8), 42) << focus_m;
            EXPECT_GT(psnr(got, truth), 37) << focus_m;
        }
    }
}

// Towards the rim of the ball its far side is seen through a caustic, but the boards behind are not.
TEST(FieldFocus, ABallsFarSideIsNotNeededToSeeThroughIt) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -1.5}, 0.5}, glass(1.5, 0.9));
    for (int i = -12; i < 12; ++i) b.add(board(i * 0.4, i * 0.4 + 0.2, -9, 9, 3.9), glowing({0.8, 0.6, 0.2}));
    b.add(board(-20, 20, -20, 20, 4), glowing({0.1, 0.2, 0.3}));
    const TracedFrame frame(b.scene, for_lens(1.4, 4));
    FocusSettings f = by_field(0.8);
    f.lens.f_number = 1.4;
    const Reference truth = rays(b.scene, f);
    const FocusResult got = focus_picture(frame.file(), f);
    EXPECT_GT(psnr(got.image, truth), 36);
    for (const FocusWarning& w : got.warnings)
        EXPECT_TRUE(w.code != "uncovered" || w.share < 0.05) << w.share;
}

}  // namespace
}  // namespace postlens::test::field_focus_test
