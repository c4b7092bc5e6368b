#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "lens/outline_rows.h"

namespace postlens::test::outline_test {
namespace {

using glm::dvec2;

Outline placed(const Outline& outline, double radius, const dvec2& centre) {
    Outline out;
    for (const dvec2& p : outline) out.push_back(centre + radius * p);
    return out;
}

/// Coverage of all pixels of a row, from column x_begin on.
std::vector<double> whole_row(const OutlineRows& rows, int y, int& x_begin) {
    CoverageSpan span;
    rows.row(y, span);
    x_begin = span.x_begin;
    std::vector<double> out;
    std::size_t edge = 0;
    for (int x = span.x_begin; x < span.x_end; ++x) {
        const bool inner = x >= span.inner_begin && x < span.inner_end;
        out.push_back(inner ? rows.inner_share() : span.edge_share[edge++]);
    }
    EXPECT_EQ(edge, span.edge_share.size());
    return out;
}

TEST(Outline, CircleHasItsAreaAndPolygonsTheirs) {
    EXPECT_NEAR(area(circle_outline(1e-3)), std::numbers::pi, 1e-12);
    for (int blades = 3; blades < 12; ++blades) {
        const double straight = blades / 2.0 * std::sin(2 * std::numbers::pi / blades);
        EXPECT_NEAR(area(blades_outline(blades, 17, 0, 1e-4)), straight, 1e-12) << blades;
        // Inscribed chords lose at most the tolerance times the circumference.
        EXPECT_NEAR(area(blades_outline(blades, 17, 1, 1e-5)), std::numbers::pi, 2 * std::numbers::pi * 1e-5);
        double before = straight;
        for (const double roundness : {0.25, 0.5, 0.75}) {
            const double now = area(blades_outline(blades, 17, roundness, 1e-5));
            EXPECT_GT(now, before) << blades << ", " << roundness;
            before = now;
        }
    }
}

TEST(Outline, CornersLieOnTheUnitCircleAndRotate) {
    const Outline square = blades_outline(4, 30, 0, 1e-3);
    ASSERT_EQ(square.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) {
        const double angle = (30 + 90.0 * static_cast<double>(k)) * std::numbers::pi / 180;
        EXPECT_NEAR(square[k].x, std::cos(angle), 1e-14);
        EXPECT_NEAR(square[k].y, std::sin(angle), 1e-14);
    }
}

// Two unit circles at distance d share 2 acos(d/2) - d/2 sqrt(4 - d^2).
TEST(Outline, IntersectionOfTwoCirclesIsTheLens) {
    const Outline circle = circle_outline(1e-6);
    for (const double d : {0.0, 0.1, 0.7, 1.3, 1.9}) {
        const double expected = 2 * std::acos(d / 2) - d / 2 * std::sqrt(4 - d * d);
        EXPECT_NEAR(area(intersection(circle, placed(circle, 1, {d, 0}))), expected, 2e-5) << d;
    }
    EXPECT_TRUE(intersection(circle, placed(circle, 1, {2.1, 0})).empty());
}

TEST(OutlineRows, AgreesWithSubsampling) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> even(0, 1);
    constexpr int n = 40;
    for (int i = 0; i < 20; ++i) {
        const double radius = 0.2 + 6 * even(random);
        const dvec2 centre(10 * even(random) - 5, 10 * even(random) - 5);
        const Outline outline =
            placed(blades_outline(3 + i % 6, 360 * even(random), even(random), 1e-3), radius, centre);
        const OutlineRows rows(outline);
        double sum = 0;
        for (int y = rows.y_begin(); y < rows.y_end(); ++y) {
            int x = 0;
            for (const double share : whole_row(rows, y, x)) {
                sum += share;
                // With n x n points, a straight edge miscounts at most one in n; a pixel may have several
                // edges.
                EXPECT_NEAR(share, outline_coverage_reference(outline, x, y, n), 4.0 / n * rows.inner_share())
                    << i << ": " << x << ", " << y;
                ++x;
            }
        }
        EXPECT_NEAR(sum, 1, 1e-12) << i;
    }
}

TEST(OutlineRows, CircleIsTheDisc) {
    const dvec2 centre(0.3, -0.1);
    for (const double radius : {0.05, 0.8, 3.0, 20.0}) {
        const double tolerance_px = 1e-4;
        const OutlineRows rows(placed(circle_outline(tolerance_px / radius), radius, centre));
        const EllipseRows disc(Ellipse::disc(radius), centre.x, centre.y);
        for (int y = std::max(rows.y_begin(), disc.y_begin()); y < std::min(rows.y_end(), disc.y_end());
             ++y) {
            int x = 0;
            const std::vector<double> shares = whole_row(rows, y, x);
            CoverageSpan span;
            disc.row(y, span);
            std::size_t edge = 0;
            for (int at = span.x_begin; at < span.x_end; ++at) {
                const bool inner = at >= span.inner_begin && at < span.inner_end;
                const double expected = inner ? disc.inner_share() : span.edge_share[edge++];
                const bool there = at >= x && at < x + static_cast<int>(shares.size());
                // The rim in a pixel is slightly longer than sqrt(2) at most, and displaced by the tolerance.
                EXPECT_NEAR(there ? shares[static_cast<std::size_t>(at - x)] : 0, expected,
                            3 * tolerance_px * disc.inner_share())
                    << radius << ": " << at << ", " << y;
            }
        }
    }
}

TEST(OutlineRows, EitherOrientationAndEveryWholeShiftGiveTheSame) {
    Outline outline = placed(blades_outline(5, 10, 0.3, 1e-3), 4.2, {0.4, 0.7});
    const OutlineRows one(outline), moved(placed(outline, 1, {30, -7}));
    std::reverse(outline.begin(), outline.end());
    const OutlineRows other(outline);
    for (int y = one.y_begin(); y < one.y_end(); ++y) {
        int x = 0, x_other = 0, x_moved = 0;
        const auto shares = whole_row(one, y, x), others = whole_row(other, y, x_other),
                   moves = whole_row(moved, y - 7, x_moved);
        ASSERT_EQ(shares.size(), others.size());
        ASSERT_EQ(shares.size(), moves.size());
        EXPECT_EQ(x, x_other);
        EXPECT_EQ(x + 30, x_moved);
        for (std::size_t i = 0; i < shares.size(); ++i) {
            EXPECT_NEAR(shares[i], others[i], 1e-14);
            EXPECT_NEAR(shares[i], moves[i], 1e-13);
        }
    }
}

// With sides at integer coordinates, pixels are wholly inside or outside.
TEST(OutlineRows, ARectangleOnThePixelGridIsExact) {
    const OutlineRows rows({{2, 1}, {7, 1}, {7, 4}, {2, 4}});
    EXPECT_EQ(rows.y_begin(), 1);
    EXPECT_EQ(rows.y_end(), 4);
    for (int y = 1; y < 4; ++y) {
        int x = 0;
        const std::vector<double> shares = whole_row(rows, y, x);
        EXPECT_EQ(x, 2);
        ASSERT_EQ(shares.size(), 5U);
        for (const double share : shares) EXPECT_DOUBLE_EQ(share, 1.0 / 15);
    }
}

}  // namespace
}  // namespace postlens::test::outline_test
