// Splines fitted to tracks: the number of knots where a minimum is known, and the tolerance.
#include "motionblur/paths/fit_path.h"

#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "core/error.h"
#include "tests/support/refusal.h"

namespace postlens::test::fit_path_test {
namespace {

using glm::dvec2;

template <typename At>
std::vector<PathPoint> sampled(const At& at, int count, double begin_s = 0, double end_s = 1) {
    std::vector<PathPoint> out;
    for (int i = 0; i < count; ++i) {
        const double t = begin_s + (end_s - begin_s) * i / (count - 1);
        out.push_back({t, at(t)});
    }
    return out;
}

// Fits a path and checks the properties that hold for every fit.
PathFit fitted(const std::vector<PathPoint>& points, double tolerance_px) {
    PathFit fit = fit_path(points, tolerance_px);
    double worst = 0;
    for (const PathPoint& p : points) worst = std::max(worst, glm::distance(fit.path.at(p.time_s), p.at_px));
    EXPECT_EQ(fit.error_px, worst);
    EXPECT_LE(fit.error_px, tolerance_px);
    EXPECT_LE(fit.path.knots(), points.size());
    return fit;
}

TEST(FitPath, AStraightTrackOfConstantSpeedHasTwoKnots) {
    const auto line = [](double t) { return dvec2(120 * t - 7, 33 * t); };
    EXPECT_EQ(fitted(sampled(line, 10'000, -2, 3), 0.01).path.knots(), 2U);
    EXPECT_EQ(fitted(sampled(line, 2), 0.01).path.knots(), 2U);
    EXPECT_EQ(fitted(sampled(line, 3), 0.01).path.knots(), 2U);
}

TEST(FitPath, ACubicInTimeHasTwoKnots) {
    EXPECT_EQ(
        fitted(sampled([](double t) { return dvec2(80 * t, 200 * t * (t - 1)); }, 1000), 0.01).path.knots(),
        2U);
    EXPECT_EQ(fitted(sampled([](double t) { return dvec2(80 * t * t * t - 60 * t * t, 9 * t); }, 1000), 0.01)
                  .path.knots(),
              2U);
}

TEST(FitPath, WhatStandsStillHasOne) {
    EXPECT_EQ(fitted(sampled([](double) { return dvec2(3, 4); }, 100), 0.01).path.knots(), 1U);
    EXPECT_EQ(
        fitted(sampled([](double t) { return 0.09 * dvec2(std::sin(99 * t), 0); }, 100), 0.1).path.knots(),
        1U);
    EXPECT_EQ(fitted({{5, {1, 2}}}, 1).path.knots(), 1U);
}

TEST(FitPath, ANoisyCircleComesNearTheFewestPossible) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(0, 1);
    for (const double tolerance_px : {2.0, 0.5, 0.1}) {
        std::vector<PathPoint> points = sampled(
            [](double t) {
                return 100.0 * dvec2(std::cos(2 * std::numbers::pi * t), std::sin(2 * std::numbers::pi * t));
            },
            3000);
        for (PathPoint& p : points) {
            const dvec2 noise(normal(random), normal(random));
            p.at_px += 0.1 * tolerance_px * noise / std::max(1.0, glm::length(noise));
        }
        // The best cubic approximation of exp(i w) over an angle a has an error of (a/2)^4 / (2^3 4!) of the
        // radius in each of the two coordinates. Noise takes a tenth of the tolerance; joints and the search
        // cost one or two segments.
        const double angle = 2 * std::pow(0.9 * tolerance_px / 100 * 192, 0.25);
        const double fewest = std::ceil(2 * std::numbers::pi / angle);
        const auto segments = static_cast<double>(fitted(points, tolerance_px).path.knots() - 1);
        EXPECT_GE(segments, fewest - 1) << tolerance_px;
        EXPECT_LE(segments, fewest + 2) << tolerance_px;
    }
}

TEST(FitPath, ABounceCostsAKnot) {
    // The bounce is between two samples, so that no knot at a sample fits it.
    const auto bounce = [](double t) {
        const double s = t < 0.41234 ? t - 0.41234 : 1.3 * (0.41234 - t);
        return dvec2(100 * t, 300 * s * (1 + 0.7 * s));
    };
    EXPECT_LE(fitted(sampled(bounce, 500), 0.05).path.knots(), 4U);
    // A path that reverses ten times needs a knot at each end and at each reversal.
    const auto saw = [](double t) {
        const double phase = 5 * t - std::floor(5 * t);
        return dvec2(40 * std::abs(2 * phase - 1), 0);
    };
    EXPECT_LE(fitted(sampled(saw, 1001), 0.05).path.knots(), 13U);
}

TEST(FitPath, NoiseAboveTheToleranceIsThePolyline) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto noise = [&](double) { return dvec2(uniform(random), uniform(random)); };
    const PathFit fit = fitted(sampled(noise, 60), 1e-9);
    EXPECT_LE(fit.path.knots(), 60U);
    const auto points = sampled(noise, 3);
    EXPECT_LE(fitted(points, 1e-12).path.knots(), 3U);
    // A tolerance below the precision of double also works.
    EXPECT_EQ(fitted(sampled(noise, 40), 1e-300).error_px, 0);
}

TEST(FitPath, ManyPointsTakeABoundedTime) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto clock = [] { return std::chrono::steady_clock::now(); };
    const auto begin = clock();
    // A hand-held camera: waves of many periods plus noise. With the second tolerance, the noise determines
    // the knots.
    const auto shake = [&](double t) {
        return dvec2(50 * std::sin(40 * t) + 5 * std::sin(311 * t), 30 * std::cos(57 * t)) +
               0.02 * dvec2(uniform(random), uniform(random));
    };
    const auto points = sampled(shake, 100'000);
    const std::size_t knots = fitted(points, 0.25).path.knots();
    EXPECT_LE(knots, 400U);
    EXPECT_GE(knots, 20U);
    (void)fitted(points, 1e-3);
    // It takes two seconds on an idle machine; sanitizers and other processes slow it down.
    EXPECT_LE(std::chrono::duration<double>(clock() - begin).count(), 60);
}

TEST(FitPath, IsDeterministic) {
    const auto wave = [](double t) { return dvec2(50 * std::sin(9 * t), 20 * std::cos(23 * t)); };
    const PathFit a = fit_path(sampled(wave, 800), 0.1), b = fit_path(sampled(wave, 800), 0.1);
    EXPECT_EQ(a.error_px, b.error_px);
    ASSERT_EQ(a.path.knots(), b.path.knots());
    for (std::size_t i = 0; i < a.path.knots(); ++i) {
        EXPECT_EQ(a.path.knot_list()[i].time_s, b.path.knot_list()[i].time_s);
        EXPECT_EQ(a.path.knot_list()[i].out_px, b.path.knot_list()[i].out_px);
    }
}

TEST(FitPath, WhatCannotBeFittedIsRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<PathPoint> good{{0, {0, 0}}, {1, {1, 1}}};
    const auto refused = [](const std::vector<PathPoint>& points, double tolerance_px,
                            const std::string& part) {
        expect_refused([&] { (void)fit_path(points, tolerance_px); }, ExitCode::wrong_arguments, part,
                       "--fit-paths: ");
    };
    for (const double bad : {0.0, -1.0, nan, inf}) refused(good, bad, "out of range (got");
    refused({}, 1, "number of points");
    refused(std::vector<PathPoint>(100'001), 1, "number of points");
    refused({{0, {}}, {0, {}}}, 1, "point 2");
    refused({{0, {}}, {nan, {}}}, 1, "point 2");
    refused({{0, {inf, 0}}}, 1, "point 1");
}

}  // namespace
}  // namespace postlens::test::fit_path_test
