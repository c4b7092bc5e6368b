// Objects with depth that move parallel to the film are convolved in slices: closed forms, conservation of
// light, and the choice of `auto`.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "core/threads.h"
#include "motionblur/groups/depth_slices.h"
#include "motionblur/motion_blur.h"
#include "tests/support/motion_frame.h"

namespace postlens::test::motion_slices_test {
namespace {

using glm::dvec2, glm::dvec3;

// Distance from the axis, m, of raster column x at a depth.
double at_column(double x, double depth_m) {
    return (x - 32) * depth_m / px_per_m;
}

// A vertical edge that is recorded at `column` and moves from `column + from` to `column + to` px during the
// exposure.
struct Edge {
    double column, from, to;
    // Fraction of the exposure in which the edge is left of x, for constant speed and a box shutter.
    [[nodiscard]] double passed(double x) const {
        return std::clamp((x - column - from) / (to - from), 0.0, 1.0);
    }
};

// Fraction of the exposure in which pixel x lies between two edges.
double between(int x, const Edge& left, const Edge& right) {
    double sum = 0;
    constexpr int steps = 1000;
    for (int i = 0; i < steps; ++i) {
        const double at = x + (i + 0.5) / steps;
        sum += left.passed(at) - right.passed(at);
    }
    return sum / steps;
}

// A rectangle over the whole height, from a column at one depth to a column at another depth.
Rectangle upright(double left, double left_depth_m, double right, double right_depth_m) {
    const dvec3 a(at_column(left, left_depth_m), -10, -left_depth_m),
        b(at_column(right, right_depth_m), -10, -right_depth_m);
    return {a, b - a, {0, 20, 0}};
}

constexpr double way_m = 0.9;

// Two bars with one id: one at 4 m that moves by 20 px, one at 5 m that moves by 16 px.
Scene two_bars() {
    SceneBuilder b;
    b.add(upright(6, 4, 14, 4), glowing(dvec3(1))).keys = from_to({way_m, 0, 0});
    Object& far = b.add(upright(38, 5, 44, 5), glowing(dvec3(0.5)));
    far.keys = from_to({way_m, 0, 0});
    far.id = 1;
    return b.scene;
}

TEST(MotionSlices, PartsOfTwoDepthsAreTrapezoidsOfTheirOwn) {
    const TracedFrame frame(two_bars(), for_shutter());
    const MotionBlurResult r = frame.blur(MotionMethod::convolve);
    ASSERT_EQ(r.objects.size(), 1U);
    EXPECT_EQ(r.objects[0].kind, MotionKind::parallax);
    EXPECT_EQ(r.objects[0].slices, 2);
    const double near_px = way_m * px_per_m / 4, far_px = way_m * px_per_m / 5;
    for (int x = 0; x < 64; ++x) {
        const double expected = between(x, {6, 0, near_px}, {14, 0, near_px}) +
                                0.5 * between(x, {38, 0, far_px}, {44, 0, far_px});
        // Tolerance as for MovingBar: edges are known to 1/8 px, and cells of 1/4 px displace the ramp's
        // ends.
        EXPECT_NEAR(static_cast<double>(r.image.pixel(x, 20)[0]), expected, (2 * 0.125 + 0.5) / far_px) << x;
    }
}

TEST(MotionSlices, LightIsConserved) {
    const TracedFrame frame(two_bars(), for_shutter());
    const double still = light_of(frame.file().picture());
    // Tolerance: cells and coverage are floats.
    EXPECT_NEAR(light_of(frame.blur(MotionMethod::convolve).image), still, 1e-5 * still);
}

// A striped board with one id that is tilted against the film. Each edge between stripes is a vertical line
// with its own speed, and the board must have no holes.
struct LeaningCase {
    std::vector<TransformKey> keys;
    int slices;
    double open_s, from_m, to_m;  ///< displacement from the record, at the exposure's begin and end (1 s)
};

TEST(MotionSlices, ALeaningBoardHasNoSeamsAndItsStripesGoTheirOwnWays) {
    const std::vector<LeaningCase> cases{
        {from_to({0.6, 0, 0}), 3, 0, 0, 0.6},
        // Recorded in the middle of the exposure, moving to the left.
        {{{.time_s = -1, .translation = {0.3, 0, 0}}, {.time_s = 1, .translation = {-0.3, 0, 0}}},
         2,
         -1,
         0.3,
         -0.3}};
    const std::vector<double> columns{18, 26, 32, 40}, radiances{0.9, 0.4, 0.7};
    constexpr double near_m = 3, far_m = 5;
    // On a plane, 1/z' is a linear function of the column.
    const auto inverse_z = [&](double x) {
        return 1 / near_m +
               (1 / far_m - 1 / near_m) * (x - columns.front()) / (columns.back() - columns.front());
    };
    for (const LeaningCase& c : cases) {
        SceneBuilder b;
        for (std::size_t i = 0; i < radiances.size(); ++i) {
            Object& o = b.add(
                upright(columns[i], 1 / inverse_z(columns[i]), columns[i + 1], 1 / inverse_z(columns[i + 1])),
                glowing(dvec3(radiances[i])));
            o.keys = c.keys;
            o.id = 1;
        }
        TraceSettings settings = for_shutter();
        settings.for_shutter = TimeSpan{c.open_s, 1};
        const TracedFrame frame(b.scene, settings);
        const MotionBlurResult r = frame.blur(MotionMethod::convolve, c.open_s, 1);
        ASSERT_EQ(r.objects.size(), 1U);
        EXPECT_EQ(r.objects[0].kind, MotionKind::parallax);
        EXPECT_EQ(r.objects[0].slices, c.slices);
        const auto edge = [&](std::size_t i) {
            const double scale = px_per_m * inverse_z(columns[i]);
            return Edge{columns[i], c.from_m * scale, c.to_m * scale};
        };
        const double shortest_px = 0.6 * px_per_m / far_m,
                     step_px = 0.6 * px_per_m * (1 / near_m - 1 / far_m) / 2;
        for (int x = 0; x < 64; ++x) {
            double expected = 0;
            for (std::size_t i = 0; i < radiances.size(); ++i) {
                const double share = std::abs(between(x, edge(i), edge(i + 1)));
                expected += radiances[i] * share;
            }
            // Edges and cells as above. An edge between two slices ends in two steps at up to half a step
            // from its position: an error of a quarter of step / way times the difference of the stripes.
            const double edges = (2 * 0.125 + 0.5) / shortest_px, slices = 0.25 * step_px / shortest_px * 0.5;
            EXPECT_NEAR(static_cast<double>(r.image.pixel(x, 20)[0]), expected, edges + slices) << x;
        }
    }
}

TEST(MotionSlices, AreWhatTheSurfacesMovedToEveryInstantAre) {
    // An accelerated motion along a curve. The slow reference is the mean of 4096 views of the same records.
    std::vector<TransformKey> keys;
    for (int i = 0; i <= 20; ++i) {
        const double t = i / 20.0;
        keys.push_back({.time_s = t, .translation = {0.6 * t * t, 0.35 * std::sin(3 * t), 0}});
    }
    SceneBuilder b;
    for (int i = 0; i < 4; ++i) {
        Object& o = b.add(Rectangle{{-0.7 + 0.2 * i, -0.5, -3.1 - 0.4 * i}, {0.2, 0, -0.4}, {0, 0.6, 0.5}},
                          glowing(i % 2 == 0 ? dvec3(0.9) : dvec3(0.2)));
        o.keys = keys;
        o.id = 1;
    }
    b.add(Rectangle{{-6, -6, -9}, {12, 0, 0}, {0, 12, 0}}, glowing(dvec3(0.4)));
    const TracedFrame frame(b.scene, for_shutter(4));
    const MotionBlurResult sliced = frame.blur(MotionMethod::convolve);
    EXPECT_EQ(sliced.objects.at(0).kind, MotionKind::parallax);
    EXPECT_GE(sliced.objects[0].slices, 3);
    const Image reference =
        motion_blur(frame.file(), {.exposure = {0, 1}, .method = MotionMethod::lightfield, .views = 4096})
            .image;
    // Ends of slices are at most one step apart, for motions of at least 10 px: an error of 1/10 of the
    // contrast of 0.7 at single edges, and a much smaller mean square.
    EXPECT_GT(psnr(sliced.image, reference), 45);
}

TEST(MotionSlices, WhatABallCoversAllTheTimeHasItsFullRadiance) {
    SceneBuilder b;
    b.add(Sphere{{-0.25, 0, -4}, 0.8}, glowing(dvec3(0.8))).keys = from_to({0.5, 0, 0});
    const TracedFrame frame(b.scene, for_shutter(4));
    const MotionBlurResult r = frame.blur(MotionMethod::convolve);
    EXPECT_EQ(r.objects.at(0).kind, MotionKind::parallax);
    // The ball's outline has a radius of 18 px about column 26.4 at the start and 37.6 at the end; pixels
    // inside of both by a pixel are tested. The surface is stretched by up to 2.3 px in 18 during the motion,
    // and compressed on the other side. Without Stretch this would change the radiance by 6 %; the remaining
    // error is 1/4 px at the outline, of 11 px.
    for (int y = 14; y < 34; ++y) {
        for (int x = 23; x < 41; ++x) {
            if (std::max(std::hypot(x + 0.5 - 26.4, y + 0.5 - 24), std::hypot(x + 0.5 - 37.6, y + 0.5 - 24)) >
                17)
                continue;
            EXPECT_NEAR(static_cast<double>(r.image.pixel(x, y)[0]), 0.8, 0.8 * 0.25 / 11) << x << ", " << y;
        }
    }
}

TEST(MotionSlices, AreContinuousWithWhatMovesAsAWhole) {
    // A slightly tilted board whose sides move apart by 0.4 px is moved as a whole (an error of 0.2 px); one
    // of 0.6 px has slices. Their images may differ by this tenth of a pixel at the sides, and by the
    // accuracy of recorded edges.
    std::vector<Image> images;
    for (const double apart_px : {0.4, 0.6}) {
        SceneBuilder b;
        const double way_px = 20, far_m = 4 / (1 - apart_px / way_px);
        b.add(upright(16, 4, 30, far_m), glowing(dvec3(1))).keys = from_to({way_px * 4 / px_per_m, 0, 0});
        const MotionBlurResult r = TracedFrame(b.scene, for_shutter()).blur(MotionMethod::automatic);
        EXPECT_EQ(r.objects.at(0).method, MotionMethod::convolve);
        EXPECT_EQ(r.objects[0].kind, apart_px < 0.5 ? MotionKind::translation : MotionKind::parallax);
        EXPECT_EQ(r.objects[0].slices, apart_px < 0.5 ? 1 : 2);
        images.push_back(r.image);
    }
    for (std::size_t i = 0; i < images[0].rgb.size(); ++i)
        EXPECT_NEAR(images[0].rgb[i], images[1].rgb[i], (0.6 + 0.125) / 19) << i;
}

TEST(MotionSlices, SameBitsForAnyNumberOfThreads) {
    SceneBuilder b;
    b.add(Sphere{{-0.25, 0, -4}, 0.8}, glowing(dvec3(0.8))).keys = from_to({0.5, 0.2, 0});
    const TracedFrame frame(b.scene, for_shutter());
    Image first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const Image image = frame.blur(MotionMethod::convolve).image;
        if (threads == 1) first = image;
        ASSERT_EQ(first.rgb.size(), image.rgb.size());
        EXPECT_EQ(std::memcmp(first.rgb.data(), image.rgb.data(), image.rgb.size() * sizeof(float)), 0)
            << threads;
    }
}

// A moving ball, with another object in the scene.
SceneBuilder ball_and(const std::function<void(SceneBuilder&)>& add) {
    SceneBuilder b;
    b.add(Sphere{{-0.25, 0, -4}, 0.8}, glowing(dvec3(0.8))).keys = from_to({0.5, 0, 0});
    add(b);
    return b;
}

TEST(MotionSlices, AutomaticTakesThemForOneSurfaceThatNothingLiesAmong) {
    struct Case {
        const char* reason;
        MotionMethod method;
        std::function<void(SceneBuilder&)> add;
    };
    const std::vector<Case> cases{
        {"slices of depth", MotionMethod::convolve, [](SceneBuilder&) {}},
        {"slices of depth", MotionMethod::convolve,
         [](SceneBuilder& b) { b.add(upright(0, 7, 64, 7), glowing(dvec3(0.3))); }},
        // A pole at a depth between the ball's nearest and farthest points.
        {"lies in its depth", MotionMethod::lightfield,
         [](SceneBuilder& b) { b.add(upright(48, 3.5, 50, 3.5), glowing(dvec3(0.3))); }},
        {"moves in the same depth", MotionMethod::lightfield,
         [](SceneBuilder& b) {
             b.add(Sphere{{0.9, 0, -3.8}, 0.3}, glowing(dvec3(0.3))).keys = from_to({-0.2, 0.3, 0});
         }},
        // A plate one metre in front of the ball with the same id.
        {"uncover", MotionMethod::lightfield, [](SceneBuilder& b) {
             Object& o = b.add(Rectangle{{-0.4, -0.2, -2.2}, {0.3, 0, 0}, {0, 0.4, 0}}, glowing(dvec3(0.3)));
             o.keys = from_to({0.5, 0, 0});
             o.id = 1;
         }}};
    for (const Case& c : cases) {
        const TracedFrame frame(ball_and(c.add).scene, for_shutter());
        const MotionBlurResult r = frame.blur(MotionMethod::automatic);
        ASSERT_FALSE(r.objects.empty());
        const ObjectReport& ball = r.objects[0];
        EXPECT_EQ(ball.kind, MotionKind::parallax) << c.reason;
        EXPECT_EQ(ball.method, c.method) << c.reason << ": " << ball.reason;
        EXPECT_NE(ball.reason.find(c.reason), std::string::npos) << ball.reason;
        EXPECT_EQ(ball.slices > 1, c.method == MotionMethod::convolve);
    }
}

TEST(MotionSlices, StretchHoldsTheLightOfWhatTurnsOverOnTheWay) {
    const std::vector<PathAxis> along{{{1, 0}, -10, 30}};
    for (const double rate : {-0.5, -0.08, -0.02, 0.0, 0.05, 0.11, 3.0}) {
        const Stretch s = stretch_of({rate, 0}, along);
        double exact = 0, line = 0, least = HUGE_VAL;
        constexpr int steps = 100000;
        for (int i = 0; i < steps; ++i) {
            const double d = -10 + 40 * (i + 0.5) / steps;
            exact += std::max(0.0, 1 + rate * d) / steps;
            line += (s.area + s.rate_per_px.x * d) / steps;
            least = std::min(least, s.area + s.rate_per_px.x * d);
        }
        EXPECT_NEAR(line, exact, 1e-6 * exact) << rate;
        EXPECT_GE(least, -1e-9) << rate;
    }
    // A surface that is reversed from the beginning on.
    EXPECT_EQ(stretch_of({-1, 0}, {{{1, 0}, 2, 30}}).area, 0);
}

}  // namespace
}  // namespace postlens::test::motion_slices_test
