// Paths on the raster: closed forms of all kinds, and flattening that preserves position and speed.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "core/error.h"
#include "motionblur/paths/screen_path.h"
#include "tests/support/refusal.h"

namespace postlens::test::motion_paths_test {
namespace {

using glm::dvec2;

// Linear interpolation between points.
dvec2 on_points(const std::vector<PathPoint>& points, double time_s) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const PathPoint &a = points[i], &b = points[i + 1];
        if (time_s > b.time_s) continue;
        const double u = (time_s - a.time_s) / (b.time_s - a.time_s);
        return (1 - u) * a.at_px + u * b.at_px;
    }
    return points.back().at_px;
}

// The greatest distance between the points and the function, over many instants.
template <typename At>
double greatest_error_px(const std::vector<PathPoint>& points, const At& at) {
    double worst = 0;
    const double open_s = points.front().time_s, close_s = points.back().time_s;
    std::size_t i = 0;
    constexpr int instants = 200'000;
    for (int k = 0; k <= instants; ++k) {
        const double t = open_s + (close_s - open_s) * k / instants;
        while (i + 2 < points.size() && t > points[i + 1].time_s) ++i;
        const PathPoint &a = points[i], &b = points[i + 1];
        const double u = (t - a.time_s) / (b.time_s - a.time_s);
        worst = std::max(worst, glm::distance((1 - u) * a.at_px + u * b.at_px, at(t)));
    }
    return worst;
}

void expect_near(dvec2 a, dvec2 b, double tolerance_px) {
    EXPECT_LE(glm::distance(a, b), tolerance_px)
        << a.x << ", " << a.y << " instead of " << b.x << ", " << b.y;
}

TEST(ScreenPaths, APolylineIsLinearInTimeAndStillOutside) {
    const ScreenPath still;
    EXPECT_EQ(still.at(-5), dvec2(0));
    EXPECT_EQ(still.flatten(0, 1).size(), 2U);
    const ScreenPath path(PathKind::polyline, {{1, {0, 0}}, {2, {10, 4}}, {4, {10, -4}}}, "test");
    EXPECT_EQ(path.knots(), 3U);
    EXPECT_EQ(path.at(0), dvec2(0, 0));
    EXPECT_EQ(path.at(1.25), dvec2(2.5, 1));
    EXPECT_EQ(path.at(2), dvec2(10, 4));
    EXPECT_EQ(path.at(3), dvec2(10, 0));
    EXPECT_EQ(path.at(9), dvec2(10, -4));
    const auto points = path.flatten(0, 3);
    ASSERT_EQ(points.size(), 4U);  // a still piece and two pieces of constant velocity
    EXPECT_EQ(points[0].time_s, 0);
    EXPECT_EQ(points[1].time_s, 1);
    EXPECT_EQ(points[2].at_px, dvec2(10, 4));
    EXPECT_EQ(points[3].time_s, 3);
    EXPECT_EQ(points[3].at_px, dvec2(10, 0));
    const auto instant = path.flatten(1.25, 1.25);
    ASSERT_EQ(instant.size(), 1U);
    EXPECT_EQ(instant[0].at_px, dvec2(2.5, 1));
}

TEST(ScreenPaths, ABezierPathIsTheCurveOfItsHandlesWithTimeAsParameter) {
    // Handles of a third of the distance give constant velocity.
    const ScreenPath straight(PathKind::bezier, {{0, {0, 0}, {}, {3, 1}}, {2, {9, 3}, {-3, -1}, {}}}, "test");
    for (int i = 0; i <= 10; ++i) expect_near(straight.at(0.2 * i), dvec2(0.9, 0.3) * double(i), 1e-14);
    // Without handles along x, x = 3 u^2 - 2 u^3. With handles of 1 along y, y = 3 u (1 - u).
    const ScreenPath ease(PathKind::bezier, {{0, {0, 0}, {}, {0, 1}}, {4, {1, 0}, {0, 1}, {}}}, "test");
    for (int i = 0; i <= 16; ++i) {
        const double u = i / 16.0;
        expect_near(ease.at(4 * u), {u * u * (3 - 2 * u), 3 * u * (1 - u)}, 1e-15);
    }
}

TEST(ScreenPaths, CatmullRomMeetsItsKnotsAndMakesParabolasOfUnevenKnots) {
    // Between inner knots, a motion with constant acceleration is exact for any times of the knots.
    const auto fall = [](double t) { return dvec2(3 * t - 1, 7 - 2 * t + 5 * t * t); };
    std::vector<PathKnot> knots;
    for (const double t : {-1.0, 0.0, 0.1, 0.7, 2.0, 2.5}) knots.push_back({t, fall(t)});
    const ScreenPath path(PathKind::catmull_rom, knots, "test");
    for (const PathKnot& k : knots) EXPECT_EQ(path.at(k.time_s), k.at_px);
    // Tolerance: a few roundings of values up to 40.
    for (int i = 0; i <= 200; ++i) expect_near(path.at(0.01 * i), fall(0.01 * i), 1e-13);
    // Two knots give a straight line with constant velocity; one knot gives a constant position.
    const ScreenPath line(PathKind::catmull_rom, {{0, {0, 0}}, {3, {6, 9}}}, "test");
    for (int i = 0; i <= 30; ++i) expect_near(line.at(0.1 * i), dvec2(0.2, 0.3) * double(i), 1e-14);
    EXPECT_EQ(ScreenPath(PathKind::catmull_rom, {{0, {5, 6}}}, "test").at(7), dvec2(5, 6));
    // The velocity is continuous: difference quotients over h on both sides of a knot differ only by h times
    // the jump of the acceleration, which is below 1000 here.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-10, 10), step(0.5, 2);
    std::vector<PathKnot> wild;
    double t = 0;
    for (int i = 0; i < 20; ++i) wild.push_back({t += step(random), {place(random), place(random)}});
    const ScreenPath smooth(PathKind::catmull_rom, wild, "test");
    constexpr double h = 1e-6;
    for (std::size_t i = 1; i + 1 < wild.size(); ++i) {
        const double at = wild[i].time_s;
        expect_near((smooth.at(at) - smooth.at(at - h)) / h, (smooth.at(at + h) - smooth.at(at)) / h,
                    1000 * h);
    }
}

TEST(ScreenPaths, WhatIsNoPathIsRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const auto refused = [](const std::vector<PathKnot>& knots, const std::string& part) {
        expect_refused([&] { (void)ScreenPath(PathKind::bezier, knots, "here:3"); }, ExitCode::invalid_input,
                       part, "here:3: ");
    };
    refused({}, "no knots");
    refused({{0, {}}, {0, {}}}, "times do not grow (got 0 s after 0 s at knot 2)");
    refused({{1, {}}, {0.5, {}}}, "times do not grow");
    refused({{nan, {}}}, "time out of range (got nan s at knot 1");
    refused({{0, {}}, {inf, {}}}, "time out of range (got inf s at knot 2");
    refused({{0, {0, nan}}}, "place or handle out of range (got 0, nan at knot 1");
    refused({{0, {0, 0}, {inf, 0}, {}}}, "place or handle out of range");
    refused({{0, {0, 0}, {}, {0, -inf}}}, "place or handle out of range");
    refused({{0, {2e12, 0}}}, "place or handle out of range");
    std::vector<PathKnot> many(100'000);
    for (std::size_t i = 0; i < many.size(); ++i) many[i].time_s = static_cast<double>(i);
    EXPECT_EQ(ScreenPath(PathKind::polyline, many, "many").knots(), 100'000U);
    many.push_back({1e6, {}});
    refused(many, "too many knots (got 100001; expected at most 100000)");
    EXPECT_THROW((void)ScreenPath().flatten(1, 0), Error);
    EXPECT_THROW((void)ScreenPath().flatten(0, 1, 0), Error);
    EXPECT_THROW((void)ScreenPath().flatten(0, inf), Error);
}

TEST(ScreenPaths, FlatteningKeepsWayAndSpeed) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-100, 100), step(0.1, 1);
    for (const PathKind kind : {PathKind::polyline, PathKind::catmull_rom, PathKind::bezier}) {
        std::vector<PathKnot> knots;
        double t = 0;
        for (int i = 0; i < 12; ++i) {
            knots.push_back({t,
                             {place(random), place(random)},
                             {place(random), place(random)},
                             {place(random), place(random)}});
            t += step(random);
        }
        const ScreenPath path(kind, knots, "test");
        for (const double tolerance_px : {1.0, 0.01}) {
            const auto points = path.flatten(-0.5, t - 1.3, tolerance_px);
            EXPECT_EQ(points.front().time_s, -0.5);
            EXPECT_EQ(points.back().time_s, t - 1.3);
            for (std::size_t i = 1; i < points.size(); ++i) ASSERT_GT(points[i].time_s, points[i - 1].time_s);
            EXPECT_LE(greatest_error_px(points, [&](double s) { return path.at(s); }), tolerance_px + 1e-9);
        }
    }
}

TEST(ScreenPaths, FlatteningHasABoundedNumberOfPoints) {
    const ScreenPath huge(PathKind::bezier,
                          {{0, {-1e12, 0}, {}, {1e12, 1e12}}, {1, {1e12, 0}, {1e12, 1e12}, {}}}, "test");
    const auto points = huge.flatten(0, 1, 1e-6);
    EXPECT_LE(points.size(), most_path_points + 1);
    EXPECT_GE(points.size(), most_path_points / 2);
    std::vector<PathKnot> many;
    for (int i = 0; i < 100'000; ++i) many.push_back({1.0 * i, {i % 2 == 0 ? 1e9 : -1e9, 0}});
    // Every segment has at least one point, even beyond the limit.
    EXPECT_LE(ScreenPath(PathKind::catmull_rom, many, "test").flatten(-1, 1e6).size(),
              most_path_points + 100'000);
}

TEST(Flatten, FollowsAnyFunctionOfTime) {
    const auto circle = [](double t) { return 100.0 * dvec2(std::cos(t), std::sin(t)); };
    const auto points = flatten(circle, {}, 0, 2 * std::numbers::pi, 0.01);
    EXPECT_LE(greatest_error_px(points, circle), 0.01);
    // A chord of angle a has an error of r (1 - cos(a / 2)), so 222 chords would suffice. A quarter of the
    // tolerance is reserved for kinks, and halving gives a power of two.
    EXPECT_EQ(points.size(), 513U);
    // A straight motion keeps the initial 16 pieces.
    EXPECT_EQ(flatten([](double t) { return dvec2(t, -t); }, {}, 0, 3).size(), 17U);
    EXPECT_EQ(flatten(circle, {}, 1, 1).size(), 1U);
}

TEST(Flatten, SeesWhatTurnsSymmetrically) {
    // Periodic motions whose period divides the initial pieces or the distances between their tests.
    for (int waves = 1; waves <= 64; ++waves) {
        const auto swing = [&](double t) {
            return 5.0 * dvec2(std::sin(2 * std::numbers::pi * waves * t),
                               std::cos(2 * std::numbers::pi * waves * t));
        };
        EXPECT_LE(greatest_error_px(flatten(swing, {}, 0, 1, 0.02), swing), 0.02) << waves;
        // A motion back and forth along a line, with a kink at each end.
        const auto saw = [&](double t) {
            const double phase = waves * t - std::floor(waves * t);
            return dvec2(40 * std::abs(2 * phase - 1), 0);
        };
        EXPECT_LE(greatest_error_px(flatten(saw, {}, 0, 1, 0.02), saw), 0.02) << waves;
    }
}

TEST(Flatten, BreaksAreMetExactly) {
    const std::vector<double> breaks{-1, 0.1, 0.3, 0.300001, 2};
    const auto bounce = [](double t) {
        return dvec2(1000 * std::abs(t - 0.3), t < 0.1 ? 0 : 500 * (t - 0.1));
    };
    const auto points = flatten(bounce, breaks, 0, 1, 0.01);
    for (const double b : {0.1, 0.3, 0.300001})
        EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](auto& p) { return p.time_s == b; })) << b;
    EXPECT_LE(greatest_error_px(points, bounce), 1e-9);
    EXPECT_LE(points.size(), 30U);
    expect_near(on_points(points, 0.3), bounce(0.3), 1e-12);
}

TEST(Flatten, IsBoundedForAnyFunction) {
    // This function does not become linear by halving.
    const auto noise = [](double t) { return dvec2(std::fmod(t * 1e9, 1000.0), 0); };
    EXPECT_LE(flatten(noise, {}, 0, 1).size(), 2 * most_path_points + 1);
    // A jump needs two points per halving.
    const auto jump = [](double t) { return dvec2(t < 0.123 ? 0 : 1e6, 0); };
    EXPECT_LE(flatten(jump, {}, 0, 1).size(), 17U + 2 * 20);
}

}  // namespace
}  // namespace postlens::test::motion_paths_test
