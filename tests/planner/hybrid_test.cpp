// Hybrid and shoot: pixels that are scattered, seen by views or traced again; lens and shutter together.
#include "planner/hybrid.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "core/error.h"
#include "core/threads.h"
#include "focus/light_field/moving_highlights.h"
#include "motionblur/paths/paths_file.h"
#include "records/sample_file.h"
#include "tests/support/motion_frame.h"
#include "tests/support/temporary_folder.h"
#include "tracer/distributed/eye_rays.h"
#include "tracer/render.h"

namespace postlens::test {
namespace {

using glm::dvec3;

constexpr ThinLens wide{.focal_length_mm = 50, .f_number = 0.7};

Rectangle board(double x0, double x1, double y0, double y1, double depth_m) {
    return {dvec3(x0, y0, -depth_m), dvec3(x1 - x0, 0, 0), dvec3(0, y1 - y0, 0)};
}

/// A striped wall (one object) and a near bar on the left.
SceneBuilder bar_and_wall() {
    SceneBuilder b;
    b.add(board(-0.34, -0.27, -2, 2, 1), glowing({0.9, 0.2, 0.1}));
    for (int i = -40; i < 40; ++i) {
        b.add(board(i * 0.35, i * 0.35 + 0.35, -9, 9, 10),
              glowing(i % 2 == 0 ? dvec3(0.9, 0.9, 0.9) : dvec3(0.15, 0.2, 0.4)))
            .id = 2;
    }
    b.scene.sha256 = std::string(64, 'a');
    return b;
}

/// Settings of a trace with or without the hidden surfaces that the lens sees past edges.
TraceSettings traced(bool hidden) {
    TraceSettings s;
    s.subdivision.levels = 4;
    if (hidden) s.for_f_number = wide.f_number;
    s.overscan_px = 24;
    return s;
}

HybridSettings settings(double focus_m, int views = 256) {
    HybridSettings s;
    s.focus = {.lens = wide, .focus_distance_m = focus_m, .method = FocusMethod::hybrid, .views = views};
    return s;
}

Image rays(const Scene& scene, const HybridSettings& h, int spp = 1024, bool halves = false) {
    RenderSettings s;
    s.focal_length_mm = h.focus.lens.focal_length_mm;
    s.f_number = h.focus.lens.f_number;
    s.focus_m = h.focus.focus_distance_m;
    s.shutter = h.shutter;
    s.spp = spp;
    s.halves = halves;
    return render_picture(scene, s).image;
}

TEST(Hybrid, ScattersWhereOneSurfaceIsSeenAndLooksElsewhere) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(true));
    const HybridSettings s = settings(3, 1024);
    const HybridResult got = hybrid_picture(frame.file(), s);
    FocusSettings f = s.focus;
    f.method = FocusMethod::lightfield;
    const Image seen = focus_picture(frame.file(), f).image;
    std::size_t of_one = 0;
    for (std::size_t k = 0; k < got.what.size(); ++k) {
        of_one += got.what[k] == 1 ? 1 : 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const float is = got.focus.image.rgb[3 * k + c], view = seen.rgb[3 * k + c];
            // In pixels that show one surface, scattering and views agree.
            ASSERT_NEAR(is, view, got.what[k] == 1 ? 0.03F : 0.0F) << k;
        }
    }
    EXPECT_GT(of_one, got.what.size() / 3);
    EXPECT_LT(of_one, got.what.size() * 9 / 10);
    const auto what = [&](int x, int y) {
        return got.what[static_cast<std::size_t>(y) * 64 + static_cast<std::size_t>(x)];
    };
    EXPECT_EQ(what(60, 24), 1);
    EXPECT_EQ(what(static_cast<int>(32 - 0.27 * px_per_m), 24), 0);  // the bar's edge
    const Image truth = rays(b.scene, s);
    EXPECT_GT(psnr(got.focus.image, truth), 42);
    EXPECT_EQ(got.retraced_share, 0);
    // With few views, scattering saves no time.
    EXPECT_EQ(hybrid_picture(frame.file(), settings(3, 16)).scattered_share, 0);
}

TEST(Hybrid, TracesAgainWhatWasNotRecorded) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(false));
    HybridSettings s = settings(10);
    const HybridResult before = hybrid_picture(frame.file(), s);
    EXPECT_GT(before.wanted_share, 0.01);
    // The largest CoC is that of the bar, which is 0.9/m out of focus.
    EXPECT_NEAR(before.focus.largest_coc_px, 2 * 0.9 * px_per_m * 0.05 / (2 * wide.f_number), 0.01);
    ASSERT_EQ(before.focus.warnings.size(), 1);
    EXPECT_EQ(before.focus.warnings[0].code, "uncovered");
    s.scene = &b.scene;
    const HybridResult after = hybrid_picture(frame.file(), s);
    EXPECT_GT(after.retraced_share, 0.01);
    EXPECT_LT(after.retraced_share, 0.5);
    EXPECT_TRUE(after.focus.warnings.empty());
    EXPECT_GT(after.rays.eye, 0);
    const Image truth = rays(b.scene, s, 4096);
    EXPECT_GT(psnr(after.focus.image, truth), psnr(before.focus.image, truth) + 3);
    // The image is as accurate as a render with the same number of rays, which also has two halves.
    EXPECT_GT(psnr(after.focus.image, truth), std::min(50.0, psnr(rays(b.scene, s, 256, true), truth)) - 0.5);
}

TEST(Hybrid, RefusesAnotherScene) {
    SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(false));
    HybridSettings s = settings(10, 16);
    Scene other = b.scene;
    other.sha256 = std::string(64, 'b');
    s.scene = &other;
    EXPECT_THROW((void)hybrid_picture(frame.file(), s), Error);
    other = b.scene;
    other.cameras[0].look_at = dvec3(0.1, 0, -1);
    EXPECT_THROW((void)hybrid_picture(frame.file(), s), Error);
    s = settings(10, 16);
    s.focus.framing = Framing::lens;
    EXPECT_THROW((void)hybrid_picture(frame.file(), s), Error);
}

TEST(Hybrid, SameBitsOnAnyThreads) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(false));
    HybridSettings s = settings(10, 16);
    s.scene = &b.scene;
    const auto with = [&](int threads) {
        const ThreadLimit limit(threads);
        return hybrid_picture(frame.file(), s).focus.image.rgb;
    };
    EXPECT_EQ(with(1), with(3));
}

TEST(RenderPixels, AreThoseOfTheWholePicture) {
    const SceneBuilder b = bar_and_wall();
    RenderSettings s;
    s.f_number = 1.4;
    s.focus_m = 2;
    s.spp = 40;
    const Image whole = render_picture(b.scene, s).image;
    const std::vector<std::uint32_t> pixels{0, 63, 64, 700, 1500, 48 * 64 - 1};
    const RenderedPixels some = render_pixels(b.scene, s, pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(some.rgb[i][c], whole.rgb[3 * pixels[i] + c], 1e-6F) << pixels[i];
    }
    EXPECT_EQ(some.rays.eye, 40 * pixels.size());
}

// Lens and shutter -------------------------------------------------------------------------------------

struct Shot {
    explicit Shot(const SceneBuilder& b, const TraceSettings& trace) : frame(b.scene, trace) {}
    TracedFrame frame;
    FrameMotion motion = motion_of(frame.file().header(), {});
    [[nodiscard]] HybridSettings settings(double focus_m, int views) const {
        HybridSettings s = test::settings(focus_m, views);
        s.motion = &motion;
        s.shutter = TimeSpan{0, 1};
        return s;
    }
};

TEST(Shoot, WithNothingThatMovesItIsTheLightField) {
    const SceneBuilder b = bar_and_wall();
    const Shot shot(b, traced(true));
    FocusSettings f = settings(3, 64).focus;
    f.method = FocusMethod::lightfield;
    EXPECT_EQ(hybrid_picture(shot.frame.file(), shot.settings(3, 64)).focus.image.rgb,
              focus_picture(shot.frame.file(), f).image.rgb);
}

// One bar crosses the defocused wall, another moves through the focus. Blurring first by the lens and then by
// motion, or in the other order, has a much larger error.
TEST(Shoot, LensAndShutterAtOnceAreWhatRaysSee) {
    SceneBuilder b = bar_and_wall();
    b.scene.objects[0].keys = from_to({0.35, 0, 0});
    Object& through = b.add(board(0.1, 0.25, -0.2, 0.2, 4), glowing({0.1, 0.8, 0.3}));
    through.id = 3;
    through.keys = from_to({0, 0, 2.5});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(2.5, 512);
    const Image truth = rays(b.scene, s), got = hybrid_picture(shot.frame.file(), s).focus.image;
    EXPECT_GT(psnr(got, truth), 38);
    HybridSettings still = s;
    still.shutter.reset();
    still.motion = nullptr;
    EXPECT_LT(psnr(hybrid_picture(shot.frame.file(), still).focus.image, truth), 30);
}

// The part of a light's disc that a bar hides is not recorded, and rays through the hole mostly miss the
// light.
TEST(Hybrid, RaysLookPastWhatHidesALampAndLeaveItsLightToTheLens) {
    SceneBuilder b;
    b.add(board(-0.02, 0.02, -0.02, 0.02, 4), glowing({60, 40, 20}));
    b.add(board(0.01, 0.05, -3, 3, 0.7), glowing({0.2, 0.2, 0.2}));
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    b.scene.sha256 = std::string(64, 'b');
    const TracedFrame frame(b.scene, traced(false));
    HybridSettings s = settings(0.9, 64);
    const Image views = hybrid_picture(frame.file(), s).focus.image;
    s.scene = &b.scene;
    const HybridResult again = hybrid_picture(frame.file(), s);
    const Image truth = rays(b.scene, s, 16384);
    // With rays there are two halves, whose mean has up to 1.5 dB more noise than one set of as many views.
    // The light's own disc has no noise.
    EXPECT_GT(psnr(again.focus.image, truth), psnr(views, truth) - 0.5);
    EXPECT_GT(psnr(again.focus.image, truth), psnr(rays(b.scene, s, 64, true), truth) + 10);
}

// An occluder of a light is used at its recorded position, but for a moving one the views give its position.
TEST(Shoot, AStillLampShinesPastAMovingBar) {
    SceneBuilder b = bar_and_wall();
    b.scene.objects[0].keys = from_to({0.35, 0, 0});
    b.add(board(-0.1, 0.1, -0.1, 0.1, 8), glowing({30, 20, 10})).id = 4;
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(0.7, 512);
    const Image truth = rays(b.scene, s), got = hybrid_picture(shot.frame.file(), s).focus.image;
    // With the bar's shadow at its recorded position it would be 29.0 dB.
    EXPECT_GT(psnr(got, truth), 33.5);
}

double sum(const Image& image) {
    double out = 0;
    for (const float v : image.rgb) out += static_cast<double>(v);
    return out;
}

/// A light that moves diagonally by 14 px, up from below the middle and towards the camera, in front of a
/// uniform wall.
SceneBuilder moving_lamp() {
    SceneBuilder b;
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    Object& lamp = b.add(board(-0.43, -0.39, -0.22, -0.18, 4), glowing({60, 40, 20}));
    lamp.id = 2;
    lamp.keys = from_to({0.5, 0.35, 1});
    return b;
}

// A light is a dot in every view. Its streak must be uniform for any number of views, with and without
// defocus.
TEST(Shoot, AMovingLampIsAStreakForAnyNumberOfViews) {
    const SceneBuilder b = moving_lamp();
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    for (const double focus_m : {3.4, 1.5}) {
        const Image truth = rays(b.scene, shot.settings(focus_m, 1), 16384),
                    few = hybrid_picture(shot.frame.file(), shot.settings(focus_m, 16)).focus.image,
                    many = hybrid_picture(shot.frame.file(), shot.settings(focus_m, 512)).focus.image;
        EXPECT_NEAR(sum(few) / sum(truth), 1, 0.01) << focus_m;
        EXPECT_NEAR(sum(many) / sum(truth), 1, 0.01) << focus_m;
        // Measured: 43.9 and 45.4 dB for one focus, 46.5 and 50.5 dB for the other.
        EXPECT_GT(psnr(few, truth), 43.3) << focus_m;
        EXPECT_GT(psnr(many, truth), 44.8) << focus_m;
    }
}

// A bar in front of the light's path hides the light for a while, at a different time for each lens point.
TEST(Shoot, AMovingLampPassesBehindABar) {
    SceneBuilder b = moving_lamp();
    b.add(board(-0.09, -0.04, -3, 3, 1.2), glowing({0.1, 0.1, 0.1})).id = 3;
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(2, 256);
    const Image truth = rays(b.scene, s, 16384), got = hybrid_picture(shot.frame.file(), s).focus.image;
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.02);
    EXPECT_GT(psnr(got, truth), 42);  // 42.9 measured
}

// The light moves through the position of the lens, and leaves the image before. The result must be finite,
// with no more light than rays see.
TEST(Shoot, AMovingLampMayPassTheCamera) {
    SceneBuilder b = moving_lamp();
    b.scene.objects[1].keys = from_to({0.41, 0.2, 5});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(2, 64);
    const Image got = hybrid_picture(shot.frame.file(), s).focus.image, truth = rays(b.scene, s, 4096);
    for (const float v : got.rgb) ASSERT_TRUE(v >= 0 && std::isfinite(v));
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.05);
}

TEST(HighlightMotion, MomentsShareTheLightAlongTheWay) {
    const PatchLens lens{.radius_px_m = 20, .inverse_focus_per_m = 0.5};
    const auto along = [](std::uint32_t /*id*/, double u) {
        glm::dmat4 m(1);
        m[2][0] = 12 * u;  // moves by 12 px to the right
        return RasterMap(m, Projection::perspective);
    };
    const HighlightMotion motion([](std::uint32_t id) { return id == 7; }, along, lens);
    Highlight light;
    light.x = 20;
    light.y = 10;
    light.rgb = {3, 2, 1};
    light.area = 0.5F;
    light.inverse_z = 0.5F;  // in focus
    light.w = Mat2::isotropic(0.5F);
    const SheetKey mine{NodePath(), 0, 7};
    EXPECT_EQ(motion.moments_wanted(light, mine), 32);  // steps of half a pixel would be 24
    const std::vector<HighlightMotion::Moment> got = motion.moments(light, mine, 32);
    ASSERT_EQ(got.size(), 32);
    double share = 0, x = 0;
    for (const HighlightMotion::Moment& m : got) {
        share += m.share;
        x += m.share * static_cast<double>(m.light.x);
        EXPECT_NEAR(static_cast<double>(m.light.x), 20 + 12 * m.u, 1e-5);
        EXPECT_EQ(m.light.y, 10);
        EXPECT_NEAR(m.light.rgb[0], 3, 1e-5F);
        EXPECT_EQ(m.light.inverse_z, 0.5F);
    }
    EXPECT_NEAR(share, 1, 1e-12);
    EXPECT_NEAR(x, 26, 1e-5);
    // With fewer moments than wanted, neighbouring lights use different moments.
    std::set<double> places;
    for (int i = 0; i < 16; ++i) {
        light.y = 10 + 0.25F * static_cast<float>(i);
        const auto few = motion.moments(light, mine, 4, true);
        ASSERT_EQ(few.size(), 4);
        for (const HighlightMotion::Moment& m : few) places.insert(m.u);
        EXPECT_NEAR(few[3].u - few[0].u, 0.75, 1e-12);
    }
    EXPECT_GT(places.size(), 4U * 8);
    light.y = 10;
    // Other objects, and mirror images of this one, do not move.
    for (const SheetKey& key :
         {SheetKey{NodePath(), 0, 8}, SheetKey{NodePath().child(NodePath::Bounce::reflected), 7, 7}}) {
        EXPECT_EQ(motion.moments_wanted(light, key), 1);
        const auto still = motion.moments(light, key, 32);
        ASSERT_EQ(still.size(), 1);
        EXPECT_EQ(still[0].u, -1);
        EXPECT_EQ(still[0].light.x, 20);
    }
    EXPECT_TRUE(HighlightMotion::takes(light, 1));  // 6 on the mean
    EXPECT_FALSE(HighlightMotion::takes(light, HighlightMotion::largest_px2));
    light.area = 2;
    EXPECT_FALSE(HighlightMotion::takes(light, 2));
}

// At half the distance a light is twice as large, has four times the area, and another CoC.
TEST(HighlightMotion, WhatComesNearerGrowsAndWhatPassesTheCameraIsGone) {
    const PatchLens lens{.radius_px_m = 20, .inverse_focus_per_m = 0.5};
    const auto nearer = [](std::uint32_t /*id*/, double u) {
        // About (0, 0): from 2 m to 0 m at u = 1.
        glm::dmat4 m(1);
        m[3][2] = -2 * u;
        return RasterMap(m, Projection::perspective);
    };
    const HighlightMotion motion([](std::uint32_t) { return true; }, nearer, lens);
    Highlight light;
    light.x = light.y = 4;
    light.rgb = {1, 1, 1};
    light.area = 1;
    light.inverse_z = 0.5F;
    light.w = Mat2::isotropic(0.5F);
    EXPECT_EQ(motion.moments_wanted(light, {NodePath(), 0, 1}), HighlightMotion::most_moments);
    const auto got = motion.moments(light, {NodePath(), 0, 1}, 1 << 16);
    ASSERT_GT(got.size(), 60000);
    EXPECT_LT(got.size(), 1U << 16U) << "the last are too near";
    for (const HighlightMotion::Moment& m : got) {
        const double depth_m = 2 - 2 * m.u, larger = 2 / depth_m;
        EXPECT_NEAR(static_cast<double>(m.light.x), 4 * larger, 1e-3 * larger);
        EXPECT_NEAR(static_cast<double>(m.light.inverse_z) * depth_m, 1, 1e-4);
        EXPECT_NEAR(static_cast<double>(m.light.rgb[1]) / (larger * larger), 1, 1e-3);
        EXPECT_EQ(m.light.w, Mat2::isotropic(m.light.inverse_z));
    }
}

/// The frame's records with the colours of an image, as a start for blurring a blurred image again.
class Recoloured {
  public:
    Recoloured(const SampleFileReader& file, const Image& image) {
        SampleHeader h = file.header();
        h.subdivide_levels = 0;
        h.has_layers = h.has_w = h.has_bend = h.has_marks = false;
        h.overscan_px = 0;
        h.key_times_s.clear();
        RecordBand from, to;
        file.read(0, h.height + 1, from);
        to.x_end = h.width + 1;
        to.y_end = h.height + 1;
        for (int y = 0; y <= h.height; ++y) {
            for (int x = 0; x <= h.width; ++x) {
                Record r = from.records[from.offsets[from.pixel(x, y)]];
                r.r = mean(image, x, y, 0);
                r.g = mean(image, x, y, 1);
                r.b = mean(image, x, y, 2);
                r.mark = 0;
                to.records.push_back(r);
                to.offsets.push_back(static_cast<std::uint32_t>(to.records.size()));
            }
        }
        SampleFileWriter writer(folder_.path() / "recoloured.exr", h, RecordCompression::none);
        writer.write(to);
        writer.finish();
        file_ = std::make_unique<SampleFileReader>(folder_.path() / "recoloured.exr");
    }
    [[nodiscard]] const SampleFileReader& file() const { return *file_; }

  private:
    /// Mean of the four pixels around a corner.
    static float mean(const Image& image, int x, int y, std::size_t channel) {
        float sum = 0;
        for (int k = 0; k < 4; ++k) {
            sum += image.pixel(std::clamp(x - (k & 1), 0, image.width - 1),
                               std::clamp(y - (k >> 1), 0, image.height - 1))[channel];
        }
        return sum / 4;
    }
    TemporaryFolder folder_;
    std::unique_ptr<SampleFileReader> file_;
};

// A post passes in front of a far, defocused wall. At each instant, different lens points see different parts
// of the wall; an image that is already blurred has lost this information.
TEST(Shoot, BlurringTwiceIsWrongInEitherOrder) {
    SceneBuilder b = bar_and_wall();
    b.scene.objects[0].keys = from_to({0.5, 0, 0});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const SampleFileReader& file = shot.frame.file();
    const HybridSettings s = shot.settings(1, 512);
    const Image truth = rays(b.scene, s);
    const double at_once = psnr(hybrid_picture(file, s).focus.image, truth);

    const MotionBlurSettings moved{.exposure = {0, 1}, .method = MotionMethod::lightfield};
    FocusSettings f = s.focus;
    f.method = FocusMethod::layers;
    const Recoloured shutter_first(file, motion_blur(file, moved).image);
    const double then_lens = psnr(focus_picture(shutter_first.file(), f).image, truth);
    f.method = FocusMethod::lightfield;
    const Recoloured lens_first(file, focus_picture(file, f).image);
    const double then_shutter = psnr(motion_blur(lens_first.file(), moved).image, truth);
    RecordProperty("at_once_db", std::to_string(at_once));
    RecordProperty("shutter_then_lens_db", std::to_string(then_lens));
    RecordProperty("lens_then_shutter_db", std::to_string(then_shutter));
    EXPECT_GT(at_once, 40);
    EXPECT_LT(then_lens, at_once - 10);
    EXPECT_LT(then_shutter, at_once - 10);
}

TEST(Shoot, KeysCarryWhatTurns) {
    SceneBuilder b = bar_and_wall();
    Object& turning = b.add(Box{{-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}}, glowing({0.1, 0.8, 0.3}));
    turning.id = 3;
    turning.keys = {
        {.time_s = 0, .translation = dvec3(0.2, 0, -3)},
        {.time_s = 1, .translation = dvec3(0.2, 0, -3), .rotation = glm::angleAxis(0.8, dvec3(0, 1, 0))}};
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    trace.keys = 3;
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(3, 256);
    EXPECT_GT(psnr(hybrid_picture(shot.frame.file(), s).focus.image, rays(b.scene, s)), 33);
}

}  // namespace
}  // namespace postlens::test
