#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "lens/ellipse_coverage.h"

namespace postlens::test::coverage_test {
namespace {

/// The sum of all coverages and their centroid, without listing the inner pixels.
struct Moments {
    double sum = 0, x = 0, y = 0, least = 1;
};

Moments moments_of(const Ellipse& e, double cx, double cy) {
    const EllipseRows rows(e, cx, cy);
    Moments m;
    CoverageSpan span;
    for (int y = rows.y_begin(); y < rows.y_end(); ++y) {
        rows.row(y, span);
        const int count = span.inner_end - span.inner_begin;
        double sum = count * rows.inner_share();
        double x_sum = sum * (span.inner_begin + span.inner_end) / 2;
        for (std::size_t i = 0; i < span.edge_share.size(); ++i) {
            const int x = span.x_begin + static_cast<int>(i);
            sum += span.edge_share[i];
            x_sum += span.edge_share[i] * ((x < span.inner_begin ? x : x + count) + 0.5);
            m.least = std::min(m.least, span.edge_share[i]);
        }
        m.sum += sum;
        m.x += x_sum;
        m.y += sum * (y + 0.5);
    }
    return m;
}

/// Compares the coverage of every pixel, and of a border of one pixel around them, with subsampling.
void expect_equals_subsampling(const Ellipse& e, double cx, double cy) {
    constexpr int n = 200;
    // A row of samples has an error below one sample at each edge that crosses it: at most 2/n of a pixel for
    // two edges. The bound holds for any ellipse; the errors seen are about a quarter of it.
    const double tolerance = 2.0 / n / e.area_px2();
    const auto rows = ellipse_coverage(e, cx, cy);
    ASSERT_FALSE(rows.empty());
    int x_begin = rows[0].x_begin, x_end = x_begin;
    for (const CoverageRow& row : rows) {
        x_begin = std::min(x_begin, row.x_begin);
        x_end = std::max(x_end, row.x_begin + static_cast<int>(row.share.size()));
    }
    const auto share = [&](int x, int y) {
        const int j = y - rows.front().y;
        if (j < 0 || j >= static_cast<int>(rows.size())) return 0.0;
        const CoverageRow& row = rows[static_cast<std::size_t>(j)];
        const int i = x - row.x_begin;
        return i < 0 || i >= static_cast<int>(row.share.size()) ? 0.0
                                                                : row.share[static_cast<std::size_t>(i)];
    };
    for (int y = rows.front().y - 1; y <= rows.back().y + 1; ++y) {
        for (int x = x_begin - 1; x <= x_end; ++x) {
            EXPECT_NEAR(share(x, y), ellipse_coverage_reference(e, cx, cy, x, y, n), tolerance)
                << "half height " << e.half_height << ", half chord " << e.half_chord << ", shear " << e.shear
                << ", centre (" << cx << ", " << cy << "), pixel (" << x << ", " << y << ")";
        }
    }
}

TEST(EllipseCoverage, DiscsEqualSubsampling) {
    for (const double radius : {0.3, 0.5, 1.0, 1.7, 4.0}) {
        for (const double phase : {0.0, 0.0625, 0.25, 0.5, 0.8125}) {
            expect_equals_subsampling(Ellipse::disc(radius), phase, 1 - phase);
        }
    }
}

TEST(EllipseCoverage, ThinAndShearedEllipsesEqualSubsampling) {
    for (const Ellipse& e :
         {Ellipse{0.2, 5.0, 0}, Ellipse{5.0, 0.2, 0}, Ellipse{4.0, 0.4, 1.3}, Ellipse{4.0, 0.4, -1.3},
          Ellipse{0.7, 2.0, 8.0}, Ellipse{3.0, 1.5, 0.4}, Ellipse{2.0, 2.0, -2.5}}) {
        for (const double phase : {0.0, 0.1875, 0.5}) expect_equals_subsampling(e, phase, 0.375 - phase);
    }
}

TEST(EllipseCoverage, RandomEllipsesEqualSubsampling) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> size(0.15, 3), shear(-3, 3), place(-1, 1);
    for (int i = 0; i < 25; ++i) {
        const Ellipse e{size(random), size(random), shear(random)};
        const double cx = place(random), cy = place(random);
        expect_equals_subsampling(e, cx, cy);
    }
}

TEST(EllipseCoverage, SharesAddUpToOneAndKeepTheCentroid) {
    for (const double radius : {1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0, 3.0, 16.0, 64.5, 333.3, 1000.0, 5000.0}) {
        for (const double phase : {0.0, 0.0625, 0.5, 0.9375}) {
            const Moments m = moments_of(Ellipse::disc(radius), phase, 0.25);
            EXPECT_NEAR(m.sum, 1, 1e-12) << radius;
            EXPECT_GE(m.least, 0) << radius;
            // The centroid within a pixel is unknown, so only a disc of several pixels is tested.
            if (radius < 3) continue;
            EXPECT_NEAR(m.x, phase, 0.01) << radius;
            EXPECT_NEAR(m.y, 0.25, 0.01) << radius;
        }
    }
    for (const Ellipse& e : {Ellipse{1e-4, 50, 0}, Ellipse{50, 1e-4, 0}, Ellipse{20, 1e-3, 2},
                             Ellipse{0.125, 40, 300}, Ellipse{700, 30, -1.5}}) {
        EXPECT_NEAR(moments_of(e, 0.375, 0.8125).sum, 1, 1e-12) << e.half_height;
    }
}

TEST(EllipseCoverage, LaysOutTheRowsOfEllipseRows) {
    const Ellipse e{9.3, 4.1, 0.7};
    const EllipseRows rows(e, 0.25, 0.75);
    const auto laid = ellipse_coverage(e, 0.25, 0.75);
    ASSERT_EQ(static_cast<int>(laid.size()), rows.y_end() - rows.y_begin());
    CoverageSpan span;
    for (const CoverageRow& row : laid) {
        rows.row(row.y, span);
        ASSERT_EQ(row.x_begin, span.x_begin);
        ASSERT_EQ(static_cast<int>(row.share.size()), span.x_end - span.x_begin);
        for (int x = span.x_begin; x < span.x_end; ++x) {
            const bool inner = x >= span.inner_begin && x < span.inner_end;
            const int skipped =
                x < span.inner_begin ? span.x_begin : span.x_begin + span.inner_end - span.inner_begin;
            EXPECT_EQ(row.share[static_cast<std::size_t>(x - span.x_begin)],
                      inner ? rows.inner_share() : span.edge_share[static_cast<std::size_t>(x - skipped)]);
        }
    }
}

TEST(EllipseCoverage, IsMirrored) {
    const auto rows = ellipse_coverage(Ellipse::disc(6.3), 0, 0);
    for (std::size_t j = 0; j < rows.size(); ++j) {
        const CoverageRow& a = rows[j];
        const CoverageRow& b = rows[rows.size() - 1 - j];
        ASSERT_EQ(a.x_begin, -static_cast<int>(a.share.size()) / 2);
        ASSERT_EQ(a.share.size(), b.share.size());
        for (std::size_t i = 0; i < a.share.size(); ++i) {
            EXPECT_NEAR(a.share[i], a.share[a.share.size() - 1 - i], 1e-15);
            EXPECT_NEAR(a.share[i], b.share[i], 1e-15);
        }
    }
}

TEST(EllipseCoverage, TinyDiscLiesInItsPixel) {
    const auto rows = ellipse_coverage(Ellipse::disc(1e-4), 3.25, -7.5);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].y, -8);
    ASSERT_EQ(rows[0].share.size(), 1U);
    EXPECT_EQ(rows[0].x_begin, 3);
    EXPECT_NEAR(rows[0].share[0], 1, 1e-12);
    // A disc centred on a pixel corner covers four pixels equally.
    double corners = 0;
    for (const CoverageRow& row : ellipse_coverage(Ellipse::disc(1e-4), 2, 2)) {
        ASSERT_EQ(row.share.size(), 2U);
        for (const double v : row.share) {
            EXPECT_NEAR(v, 0.25, 1e-12);
            corners += v;
        }
    }
    EXPECT_NEAR(corners, 1, 1e-12);
}

TEST(EllipseRows, InnerRunIsInsideAndAsLongAsCanBe) {
    const Ellipse e{12.4, 7.7, 0.6};
    const EllipseRows rows(e, 0.3125, 0.6875);
    const double full = 1 / e.area_px2();
    const auto inside = [&](double x, double y) {
        const double t = y - 0.6875, v = (x - 0.3125 - e.shear * t) / e.half_chord, u = t / e.half_height;
        return u * u + v * v <= 1;
    };
    EXPECT_NEAR(rows.inner_share(), full, 1e-15);
    CoverageSpan span;
    for (int y = rows.y_begin(); y < rows.y_end(); ++y) {
        rows.row(y, span);
        ASSERT_LE(span.x_begin, span.inner_begin);
        ASSERT_LE(span.inner_begin, span.inner_end);
        ASSERT_LE(span.inner_end, span.x_end);
        ASSERT_EQ(span.edge_share.size(),
                  static_cast<std::size_t>(span.x_end - span.x_begin - (span.inner_end - span.inner_begin)));
        // A convex shape contains a pixel if and only if it contains the pixel's corners.
        for (int x = span.x_begin; x < span.x_end; ++x) {
            const bool whole = inside(x, y) && inside(x + 1, y) && inside(x, y + 1) && inside(x + 1, y + 1);
            EXPECT_EQ(x >= span.inner_begin && x < span.inner_end, whole) << x << " " << y;
        }
    }
}

/// Checks that M maps the unit circle to the outline of the ellipse.
void expect_outline(const glm::dmat2& m) {
    const Ellipse e = Ellipse::from_map(m, 1e-6);
    for (int i = 0; i < 64; ++i) {
        const double a = 2 * std::numbers::pi * i / 64;
        const glm::dvec2 p = m * glm::dvec2(std::cos(a), std::sin(a));
        const double u = p.y / e.half_height, v = (p.x - e.shear * p.y) / e.half_chord;
        EXPECT_NEAR(u * u + v * v, 1, 1e-9);
    }
    EXPECT_NEAR(e.area_px2(), std::numbers::pi * std::abs(glm::determinant(m)), 1e-9);
}

TEST(Ellipse, ComesFromAMap) {
    expect_outline(glm::dmat2(3, 0, 0, 3));
    expect_outline(glm::dmat2(3, 1, -2, 5));
    expect_outline(glm::dmat2(0.2, 4, 3, -0.1));
    expect_outline(glm::dmat2(-2, 0, 0, 7));
}

TEST(Ellipse, RaisesSemiAxesThatAreTooShort) {
    const Ellipse point = Ellipse::from_map(glm::dmat2(0.0), 0.25);
    EXPECT_EQ(point.half_height, 0.25);
    EXPECT_EQ(point.half_chord, 0.25);
    EXPECT_EQ(point.shear, 0);
    // A line of half length 5 along (3, 4) / 5 becomes an ellipse of semi-axes 5 and 0.25.
    const Ellipse line = Ellipse::from_map(glm::dmat2(3, 4, 0, 0), 0.25);
    EXPECT_NEAR(line.area_px2(), std::numbers::pi * 5 * 0.25, 1e-9);
    for (int i = 0; i < 16; ++i) {
        const double a = 2 * std::numbers::pi * i / 16;
        const glm::dvec2 p =
            5 * std::cos(a) * glm::dvec2(0.6, 0.8) + 0.25 * std::sin(a) * glm::dvec2(-0.8, 0.6);
        const double u = p.y / line.half_height, v = (p.x - line.shear * p.y) / line.half_chord;
        EXPECT_NEAR(u * u + v * v, 1, 1e-9);
    }
    const Ellipse flat = Ellipse::from_map(glm::dmat2(5, 0, 0, 0), 0.25);
    EXPECT_NEAR(flat.half_height, 0.25, 1e-12);
    EXPECT_NEAR(flat.half_chord, 5, 1e-12);
}

}  // namespace
}  // namespace postlens::test::coverage_test
