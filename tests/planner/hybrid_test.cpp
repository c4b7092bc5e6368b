// The hybrid method: pixels that are scattered, taken from views or traced again.
#include "planner/hybrid.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/job.h"
#include "focus/focus.h"
#include "tests/planner/bar_scene.h"
#include "tests/support/motion_frame.h"
#include "tests/support/reference.h"
#include "tracer/render.h"

namespace postlens::test::hybrid_test {
namespace {

using glm::dvec3;

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
    const Image truth = rendered_within(b.scene, by_rays(s, 16384), {24, 0, 24, 48});
    // With rays there are two halves, whose mean has up to 1.5 dB more noise than one set of as many views.
    // The light's own disc has no noise.
    EXPECT_GT(psnr(again.focus.image, truth), psnr(views, truth) - 1.5);
    EXPECT_GT(psnr(again.focus.image, truth), psnr(rays(b.scene, s, 64, true), truth) + 10);
}

}  // namespace
}  // namespace postlens::test::hybrid_test
