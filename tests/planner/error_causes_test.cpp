// Causes of errors: images with one known fault each, and the cause that is reported for them.
#include "planner/error_causes.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/threads.h"
#include "tests/planner/bar_scene.h"
#include "tests/support/motion_frame.h"
#include "tracer/render.h"

namespace postlens::test::error_causes_test {
namespace {

using glm::dvec3;

SceneBuilder bar_and_broad_stripes() {
    SceneBuilder b;
    b.add(board(-0.1, -0.02, -2, 2, 1), glowing({0.9, 0.2, 0.1}));
    for (int i = -40; i < 40; ++i) {
        b.add(board(i * 0.9, i * 0.9 + 0.9, -9, 9, 10),
              glowing(i % 2 == 0 ? dvec3(0.9, 0.9, 0.9) : dvec3(0.15, 0.2, 0.4)))
            .id = 2;
    }
    return b;
}

TraceSettings traced(bool hidden, int levels, int overscan_px) {
    TraceSettings s = test::traced(hidden, levels);
    s.overscan_px = overscan_px;
    return s;
}

Image rays(const Scene& scene, const ThinLens& lens, double focus_m) {
    RenderSettings s;
    s.focal_length_mm = lens.focal_length_mm;
    s.f_number = lens.f_number;
    s.focus_m = focus_m;
    s.spp = 4096;
    return render_picture(scene, s).image;
}

struct Found {
    CauseMap map;
    [[nodiscard]] double share(ErrorCause c) const { return map.error_share[static_cast<std::size_t>(c)]; }
};

Found found(const TracedFrame& traced_frame, const Scene& scene, const FocusSettings& made_by) {
    FocusFrame frame(traced_frame.file());
    CauseRequest request;
    request.view.focus = made_by;
    request.method = made_by.method;
    request.depths = made_by.depths;
    return {find_error_causes(frame, focus_picture(frame, made_by).image,
                              rays(scene, made_by.lens, made_by.focus_distance_m), request)};
}

FocusSettings settings(FocusMethod method, double focus_m) {
    FocusSettings s{.lens = wide, .focus_distance_m = focus_m, .method = method};
    s.views = 256;
    return s;
}

TEST(ErrorCauses, WhatWasNotRecordedBehindANearEdge) {
    const SceneBuilder b = bar_and_broad_stripes();
    const TracedFrame frame(b.scene, traced(false, 4, 32));
    const Found f = found(frame, b.scene, settings(FocusMethod::lightfield, 10));
    EXPECT_GT(f.share(ErrorCause::hidden_surface), 0.8);
}

TEST(ErrorCauses, SurfacesInTheWrongOrder) {
    const SceneBuilder b = bar_and_broad_stripes();
    const TracedFrame frame(b.scene, traced(true, 4, 32));
    const Found f = found(frame, b.scene, settings(FocusMethod::scatter, 10));
    EXPECT_GT(f.share(ErrorCause::visibility), 0.8);
}

TEST(ErrorCauses, TooFewCirclesOfConfusion) {
    // A tilted board from 1 m to 4 m, blurred with only two responses.
    SceneBuilder b;
    for (int i = -30; i < 30; ++i) {
        b.add(Rectangle{dvec3(0.15 * i, -0.8, -1), dvec3(0.15, 0, 0), dvec3(0, 2.2, -3)},
              glowing(i % 2 == 0 ? dvec3(0.9, 0.9, 0.9) : dvec3(0.15, 0.2, 0.4)))
            .id = 2;
    }
    const TracedFrame frame(b.scene, traced(false, 4, 32));
    FocusSettings s = settings(FocusMethod::scatter, 2);
    s.depths = 3;
    const Found f = found(frame, b.scene, s);
    EXPECT_GT(f.share(ErrorCause::kernel_truncation), 0.8);
}

TEST(ErrorCauses, LightFromBeyondTheMargin) {
    // A defocused wall that is brighter towards the border, without overscan.
    SceneBuilder b;
    b.add(board(-9, 9, -9, 9, 10), glowing({0.1, 0.1, 0.1}));
    b.add(board(3.3, 9, -9, 9, 9.99), glowing({0.9, 0.9, 0.9}));
    const TracedFrame frame(b.scene, traced(true, 3, 0));
    const Found f = found(frame, b.scene, settings(FocusMethod::scatter, 0.8));
    EXPECT_GT(f.share(ErrorCause::frame_edge), 0.8);
}

TEST(ErrorCauses, RecordsTooFar) {
    const SceneBuilder b = bar_and_broad_stripes();
    const TracedFrame frame(b.scene, traced(true, 0, 8));
    FocusSettings s = settings(FocusMethod::lightfield, 10);
    s.lens.f_number = 64;
    const Found f = found(frame, b.scene, s);
    EXPECT_GT(f.share(ErrorCause::record_density), 0.8);
}

TEST(ErrorCauses, NothingIsWrongWhereNothingIs) {
    const SceneBuilder b = bar_and_broad_stripes();
    const TracedFrame frame(b.scene, traced(true, 3, 16));
    FocusFrame of(frame.file());
    CauseRequest request;
    request.view.focus = settings(FocusMethod::layers, 10);
    const Image image = focus_picture(of, request.view.focus).image;
    const CauseMap map = find_error_causes(of, image, image, request);
    for (const ErrorCause c : map.causes) ASSERT_EQ(c, ErrorCause::none);
    for (const double share : map.error_share) EXPECT_EQ(share, 0);
    EXPECT_THROW((void)find_error_causes(of, image, Image(3, 3), request), Error);
}

TEST(ErrorCauses, SameForAnyNumberOfThreads) {
    const SceneBuilder b = bar_and_broad_stripes();
    const TracedFrame frame(b.scene, traced(false, 2, 4));
    CauseRequest request;
    request.view.focus = settings(FocusMethod::scatter, 10);
    const Image truth = rays(b.scene, wide, 10);
    const auto map = [&](int threads) {
        const ThreadLimit limit(threads);
        FocusFrame of(frame.file());
        return find_error_causes(of, focus_picture(of, request.view.focus).image, truth, request);
    };
    const CauseMap one = map(1), five = map(5);
    EXPECT_EQ(one.causes, five.causes);
    EXPECT_EQ(one.error_share, five.error_share);
}

}  // namespace
}  // namespace postlens::test::error_causes_test
