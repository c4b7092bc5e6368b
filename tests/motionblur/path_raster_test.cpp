// Path rasters: closed forms, conservation of light, and a sum over many instants as the slow reference.
#include "motionblur/paths/path_raster.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "core/error.h"
#include "tests/motionblur/drawn_path.h"
#include "tests/support/refusal.h"

namespace postlens::test::path_raster_test {
namespace {

using glm::dvec2;

double sum(const PathRaster& r) {
    return std::accumulate(r.weight.begin(), r.weight.end(), 0.0);
}

double weight_or_zero(const PathRaster& r, int x, int y) {
    const bool inside =
        x >= r.x_begin && x < r.x_begin + r.width && y >= r.y_begin && y < r.y_begin + r.height;
    return inside ? r.at(x, y) : 0;
}

// The slow reference: adds many instants, each in the middle of an equal part of the light.
PathRaster reference(const std::vector<PathPoint>& points, dvec2 origin_px, double open_s, double close_s,
                     const ShutterCurve& curve, int cells, const PathRaster& window, int instants) {
    PathRaster out = window;
    out.weight.assign(out.weight.size(), 0.0);
    for (int k = 0; k < instants; ++k) {
        const double t = open_s + (close_s - open_s) * curve.time((k + 0.5) / instants);
        dvec2 at = t <= points.front().time_s ? points.front().at_px : points.back().at_px;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const PathPoint &a = points[i], &b = points[i + 1];
            if (t < a.time_s || t >= b.time_s) continue;
            const double u = (t - a.time_s) / (b.time_s - a.time_s);
            at = (1 - u) * a.at_px + u * b.at_px;
        }
        const dvec2 cell = glm::floor(static_cast<double>(cells) * (at - origin_px) + 0.5);
        const int x = static_cast<int>(cell.x) - out.x_begin, y = static_cast<int>(cell.y) - out.y_begin;
        if (x < 0 || y < 0 || x >= out.width || y >= out.height) {
            ADD_FAILURE() << "outside of the raster: " << cell.x << ", " << cell.y;
            break;
        }
        out.weight[static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) +
                   static_cast<std::size_t>(x)] += 1.0 / instants;
    }
    return out;
}

TEST(PathRasters, AStillPointIsOneCell) {
    for (const int cells : {1, 2, 4}) {
        for (const auto& points : {std::vector<PathPoint>{{0, {3.2, -7.4}}},
                                   std::vector<PathPoint>{{0, {3.2, -7.4}}, {1, {3.2, -7.4}}}}) {
            const PathRaster r = draw_path(points, {1, 1}, 0, 1, ShutterCurve::triangle(), cells);
            EXPECT_EQ(r.width, 1);
            EXPECT_EQ(r.height, 1);
            EXPECT_EQ(r.x_begin, std::lround(2.2 * cells));
            EXPECT_EQ(r.y_begin, std::lround(-8.4 * cells));
            EXPECT_EQ(r.weight, std::vector<double>{1.0});
            EXPECT_EQ(r.cells_per_px, cells);
        }
    }
    // An exposure of length 0 gives the position at that instant.
    const std::vector<PathPoint> moving{{0, {0, 0}}, {1, {10, 0}}};
    const PathRaster instant = draw_path(moving, dvec2(0), 1, 1, ShutterCurve::box(), 1);
    EXPECT_EQ(instant.x_begin, 10);
    EXPECT_EQ(instant.weight, std::vector<double>{1.0});
}

TEST(PathRasters, ACellIsHalfOpen) {
    // A position on the border of two cells belongs to the cell with the greater index, along both axes.
    const auto cell = [](double x, double y) {
        const PathRaster r = draw({{0, {x, y}}, {1, {x, y}}});
        EXPECT_EQ(r.weight.size(), 1U);
        return std::pair(r.x_begin, r.y_begin);
    };
    EXPECT_EQ(cell(0.5, -0.5), std::pair(1, 0));
    EXPECT_EQ(cell(0.5 - 1e-15, -0.5 - 1e-15), std::pair(0, -1));
}

TEST(PathRasters, ConstantSpeedWeighsLengths) {
    for (const int cells : {1, 2, 4}) {
        const PathRaster r = draw({{0, {0, 0}}, {1, {10, 0}}}, cells);
        EXPECT_EQ(r.x_begin, 0);
        EXPECT_EQ(r.width, 10 * cells + 1);
        EXPECT_EQ(r.height, 1);
        for (int x = 0; x < r.width; ++x) {
            const bool end = x == 0 || x == r.width - 1;
            EXPECT_NEAR(r.at(x, 0), (end ? 0.5 : 1.0) / (10 * cells), 1e-15) << x;
        }
    }
}

TEST(PathRasters, ATriangularShutterWeighsTheDifferenceOfItsLight) {
    const PathRaster r = draw({{2, {0, 0}}, {4, {0, -8}}}, 1, ShutterCurve::triangle());
    EXPECT_EQ(r.y_begin, -8);
    EXPECT_EQ(r.height, 9);
    const auto light = [](double u) {
        u = std::clamp(u, 0.0, 1.0);
        return u <= 0.5 ? 2 * u * u : 1 - 2 * (1 - u) * (1 - u);
    };
    for (int k = 0; k <= 8; ++k)
        EXPECT_NEAR(r.at(0, -k), light((k + 0.5) / 8) - light((k - 0.5) / 8), 1e-15) << k;
}

TEST(PathRasters, FromRestTheWeightsFollowTheRoot) {
    // For x = a t^2, the path leaves cell k at t = sqrt((k + 1/2) / a).
    const double a = 40;
    const ScreenPath path(PathKind::bezier, {{0, {0, 0}, {}, {0, 0}}, {1, {a, 0}, {-2 * a / 3, 0}, {}}},
                          "test");
    const double tolerance_px = 1e-6;
    const auto points = path.flatten(0, 1, tolerance_px);
    const PathRaster r = draw(points);
    EXPECT_EQ(r.width, 41);
    for (int k = 0; k <= 40; ++k) {
        const double until = std::sqrt(std::min(k + 0.5, a) / a);
        const double from = k == 0 ? 0 : std::sqrt((k - 0.5) / a);
        // An error dx of the path changes the time of a crossing by dt = dx / (2 a t), where t >= sqrt(1/2 /
        // a). A cell has two crossings.
        EXPECT_NEAR(r.at(k, 0), until - from, 2 * tolerance_px / (2 * a * std::sqrt(0.5 / a))) << k;
    }
}

TEST(PathRasters, ADiagonalCrossesWhereItDoes) {
    // The path starts at the centre of cell (0, 0) along (3, 1). It crosses borders of columns at x = 1/2,
    // 3/2, ..., and the border of a row at y = 1/2, where x = 3/2 is also the border of a column.
    const PathRaster r = draw({{0, {0, 0}}, {1, {6, 2}}});
    ASSERT_EQ(r.width, 7);
    ASSERT_EQ(r.height, 3);
    const double part = 1.0 / 6;
    const double expected[3][7] = {
        {part / 2, part, 0, 0, 0, 0, 0}, {0, 0, part, part, part, 0, 0}, {0, 0, 0, 0, 0, part, part / 2}};
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 7; ++x) EXPECT_NEAR(r.at(x, y), expected[y][x], 1e-15) << x << ", " << y;
    // A path of slope 1/2 through (0.25, 0) reaches y = 1/2 at x = 1.25.
    const PathRaster s = draw({{0, {0.25, 0}}, {1, {2.25, 1}}});
    EXPECT_NEAR(s.at(0, 0), 0.25 / 2, 1e-15);
    EXPECT_NEAR(s.at(1, 0), 0.75 / 2, 1e-15);
    EXPECT_NEAR(s.at(1, 1), 0.25 / 2, 1e-15);
    EXPECT_NEAR(s.at(2, 1), 0.75 / 2, 1e-15);
    EXPECT_EQ(s.at(0, 1), 0);
}

TEST(PathRasters, ThereAndBackIsThereOnce) {
    const PathRaster once = draw({{0, {0.3, 0.1}}, {1, {12.7, 5.2}}});
    const PathRaster back = draw({{0, {0.3, 0.1}}, {1, {12.7, 5.2}}, {2, {0.3, 0.1}}});
    ASSERT_EQ(once.weight.size(), back.weight.size());
    for (std::size_t i = 0; i < once.weight.size(); ++i) EXPECT_NEAR(once.weight[i], back.weight[i], 1e-15);
}

TEST(PathRasters, ACircleRunTwiceIsTheCircleOnce) {
    const auto circle = [](double t) {
        const double a = 2 * std::numbers::pi * t;
        return dvec2(20 * std::cos(a), 20 * std::sin(a));
    };
    // One and two periods are flattened to equal pieces, 512 and 1024 of them.
    const auto once_points = flatten(circle, {}, 0, 1, 0.01), twice_points = flatten(circle, {}, 0, 2, 0.01);
    ASSERT_EQ(2 * (once_points.size() - 1), twice_points.size() - 1);
    const PathRaster once = draw(once_points, 2), twice = draw(twice_points, 2);
    ASSERT_EQ(once.weight.size(), twice.weight.size());
    // sin and cos of the second period differ from the first by rounding of the angles, 20 px times 2^-50.
    // Crossings differ by that divided by a speed of 126 px per period.
    for (std::size_t i = 0; i < once.weight.size(); ++i) EXPECT_NEAR(once.weight[i], twice.weight[i], 1e-14);
}

// A path of pieces with random velocity and duration.
std::vector<PathPoint> random_points(std::mt19937& random, int count) {
    std::uniform_real_distribution<double> place(-6, 6), step(0.01, 1);
    std::vector<PathPoint> points;
    double t = -1;
    for (int i = 0; i < count; ++i) {
        t += step(random);
        // Some pieces do not move, some points lie on borders of cells.
        dvec2 at(place(random), place(random));
        if (i % 5 == 3) at = points.back().at_px;
        if (i % 7 == 2) at = glm::floor(at) + 0.5;
        points.push_back({t, at});
    }
    return points;
}

TEST(PathRasters, ConserveLightAndItsCentre) {
    std::mt19937 random(2);
    for (int run = 0; run < 200; ++run) {
        const auto points = random_points(random, 2 + run % 20);
        const int cells = 1 + run % 4;
        const bool is_box = run % 2 == 0;
        const PathRaster r = draw(points, cells, is_box ? ShutterCurve::box() : ShutterCurve::triangle());
        // Tolerance: one rounding of at most 2^-53 for each of about a hundred parts.
        EXPECT_NEAR(sum(r), 1, 1e-13);
        for (const double w : r.weight) ASSERT_GE(w, 0);
    }
}

TEST(PathRasters, TheCentroidOfFineCellsIsThatOfThePath) {
    // The path runs between centres of cells along rows and columns, so rounding to cells does not change the
    // centroid.
    const std::vector<PathPoint> points{{0, {0, 0}}, {0.3, {12, 0}}, {0.4, {12, 5}}, {1, {-7, 5}}};
    for (const int cells : {1, 2, 4}) {
        const PathRaster r = draw(points, cells);
        dvec2 centre(0);
        for (int y = r.y_begin; y < r.y_begin + r.height; ++y)
            for (int x = r.x_begin; x < r.x_begin + r.width; ++x) centre += r.at(x, y) * dvec2(x, y);
        centre /= cells;
        dvec2 expected(0);
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            expected +=
                0.5 * (points[i].at_px + points[i + 1].at_px) * (points[i + 1].time_s - points[i].time_s);
        }
        EXPECT_NEAR(centre.x, expected.x, 1e-12);
        EXPECT_NEAR(centre.y, expected.y, 1e-12);
    }
}

TEST(PathRasters, AgreeWithManyInstants) {
    std::mt19937 random(4);
    const ShutterCurve uneven =
        ShutterCurve::points({{0, 0.2}, {0.3, 1}, {0.5, 0}, {0.6, 0}, {1, 0.7}}, "test");
    for (int run = 0; run < 24; ++run) {
        const auto points = random_points(random, 2 + run % 9);
        const ShutterCurve curve = run % 3 == 0   ? ShutterCurve::box()
                                   : run % 3 == 1 ? ShutterCurve::triangle()
                                                  : uneven;
        // The exposure may begin before the path, end after it, or cover a part of it.
        const double open_s = points.front().time_s + (run % 4 - 1) * 0.1;
        const double close_s = std::max(points.back().time_s + (run % 5 - 2) * 0.1, open_s + 0.01);
        const dvec2 origin(0.37, -1.2);
        const int cells = 1 + run % 3;
        const PathRaster exact = draw_path(points, origin, open_s, close_s, curve, cells);
        constexpr int instants = 200'000;
        const PathRaster many = reference(points, origin, open_s, close_s, curve, cells, exact, instants);
        for (std::size_t i = 0; i < exact.weight.size(); ++i) {
            // Each visit of a cell has an error of at most one instant, and 10 pieces make at most two visits
            // each.
            EXPECT_NEAR(exact.weight[i], many.weight[i], 20.0 / instants) << run;
        }
    }
}

TEST(PathRasters, AWindowKeepsItsCellsAndDropsTheRest) {
    std::mt19937 random(5);
    for (int run = 0; run < 100; ++run) {
        const auto points = random_points(random, 2 + run % 12);
        const PathRaster all = draw(points, 2, ShutterCurve::triangle());
        const CellWindow keep{-7 + run % 5, 3 + run % 6, -2, 9 - run % 8};
        const PathRaster kept = draw_path(points, dvec2(0), points.front().time_s, points.back().time_s,
                                          ShutterCurve::triangle(), 2, keep);
        for (int y = -13; y <= 13; ++y) {
            for (int x = -13; x <= 13; ++x) {
                const bool inside =
                    x >= keep.x_begin && x < keep.x_end && y >= keep.y_begin && y < keep.y_end;
                EXPECT_NEAR(weight_or_zero(kept, x, y), inside ? weight_or_zero(all, x, y) : 0, 1e-13);
            }
        }
    }
    // A path that extends far beyond the window gives the weights of its speed inside.
    const double far_px = 1e9;
    const PathRaster cut =
        draw_path(std::vector<PathPoint>{{0, {-far_px, 0.2}}, {1, {far_px, 0.2}}}, dvec2(0), 0, 1,
                  ShutterCurve::box(), 2, CellWindow{-100, 100, -100, 100});
    EXPECT_EQ(cut.width, 200);
    EXPECT_EQ(cut.height, 1);
    // Times have an error of 2^-53 of the exposure, and a cell lasts 1 / (4 far).
    for (const double w : cut.weight) EXPECT_NEAR(w, 1 / (4 * far_px), 1e-15);
    const PathRaster none = draw_path(std::vector<PathPoint>{{0, {50, 50}}}, dvec2(0), 0, 1,
                                      ShutterCurve::box(), 1, CellWindow{0, 10, 0, 10});
    EXPECT_TRUE(none.weight.empty());
    EXPECT_EQ(none.width, 0);
}

TEST(PathRasters, WhatCannotBeDrawnIsRefused) {
    const ShutterCurve box = ShutterCurve::box();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const auto refused = [&](const std::vector<PathPoint>& points, double open_s, double close_s, int cells,
                             const std::string& part) {
        expect_refused([&] { (void)draw_path(points, dvec2(0), open_s, close_s, box, cells); },
                       ExitCode::wrong_arguments, part);
    };
    refused({}, 0, 1, 1, "no points");
    refused({{0, {}}}, 1, 0, 1, "must not come before open");
    refused({{0, {}}}, nan, 0, 1, "must not come before open");
    refused({{0, {}}}, -inf, 0, 1, "must not come before open");
    refused({{0, {}}}, 0, 1, 0, "cells per pixel");
    refused({{0, {nan, 0}}}, 0, 1, 1, "place out of range (got nan px, 0 px");
    refused({{0, {0, 0}}, {1, {0, inf}}}, 0, 1, 1, "place out of range");
    refused({{0, {0, 0}}, {1, {1e300, 0}}}, 0, 1, 1, "place out of range");
    refused({{0, {0, 0}}, {1, {1e9, 0}}}, 0, 1, 2,
            "too long (spans 1e+09 px, 1e+09 px away; expected at most 500000)");
    refused({{0, {5e9, 0}}}, 0, 1, 1, "too long");
    // A path of small extent that goes back and forth very often.
    std::vector<PathPoint> wild;
    for (int i = 0; i < 2'001; ++i) wild.push_back({1.0 * i, {i % 2 * 200'000.0, 0}});
    refused(wild, 0, 2000, 1, "too long a way");
    // 10^12 cells exceed the available memory.
    expect_refused(
        [&] {
            (void)draw_path(std::vector<PathPoint>{{0, {0, 0}}, {1, {999'990, 999'990}}}, dvec2(0), 0, 1, box,
                            1);
        },
        ExitCode::out_of_memory, "memory");
}

TEST(PathRasters, ValuesWeighTheLight) {
    const std::vector<PathPoint> points{{0, {0, 0}}, {1, {10, 0}}};
    const std::vector<double> values{2, 12};
    const PathRaster r = draw_path(points, dvec2(0), 0, 1, ShutterCurve::box(), 1, std::nullopt, values);
    ASSERT_EQ(r.width, 11);
    // Cell i gets a tenth of the light, while the value changes from i + 1.5 to i + 2.5. The cells at the
    // ends get half of that.
    for (int i = 1; i < 10; ++i) EXPECT_NEAR(r.at(i, 0), 0.1 * (i + 2), 1e-12) << i;
    EXPECT_NEAR(r.at(0, 0), 0.05 * 2.25, 1e-12);
    EXPECT_NEAR(r.at(10, 0), 0.05 * 11.75, 1e-12);
    // A window does not change the weights inside. Half of the exposure gives half of the path.
    const PathRaster kept =
        draw_path(points, dvec2(0), 0, 1, ShutterCurve::box(), 1, CellWindow{3, 6, 0, 1}, values);
    for (int i = 3; i < 6; ++i) EXPECT_NEAR(kept.at(i, 0), r.at(i, 0), 1e-12) << i;
    const PathRaster half = draw_path(points, dvec2(0), 0, 0.5, ShutterCurve::box(), 1, std::nullopt, values);
    for (int i = 1; i < 5; ++i) EXPECT_NEAR(half.at(i, 0), 2 * r.at(i, 0), 1e-12) << i;
    // With values of 1, the result is bit-identical to that without values.
    const std::vector<double> ones{1, 1};
    EXPECT_EQ(draw_path(points, dvec2(0), -1, 2, ShutterCurve::triangle(), 2, std::nullopt, ones).weight,
              draw_path(points, dvec2(0), -1, 2, ShutterCurve::triangle(), 2).weight);
}

}  // namespace
}  // namespace postlens::test::path_raster_test
