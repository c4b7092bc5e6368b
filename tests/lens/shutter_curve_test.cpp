// Shutter curves: closed forms, the inverse of the accumulated light, and files of points.
#include "lens/shutter_curve.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::shutter_curve_test {
namespace {

namespace fs = std::filesystem;

TEST(ShutterCurves, ABoxIsExact) {
    const ShutterCurve box = ShutterCurve::box();
    EXPECT_TRUE(box.is_box());
    for (int i = 0; i <= 1024; ++i) {
        const double u = i / 1024.0;
        EXPECT_EQ(box.time(u), u);
        EXPECT_EQ(box.density(u), 1);
        EXPECT_EQ(box.light(u), u);
    }
    for (const double u : {0.1, 0.3, 1 - 0x1p-24, 0x1p-24}) EXPECT_EQ(box.time(u), u);
    EXPECT_EQ(box.density(-1e-9), 0);
    EXPECT_EQ(box.density(1 + 1e-9), 0);
    EXPECT_EQ(box.light(-1e-9), 0);
    EXPECT_EQ(box.light(1 + 1e-9), 1);
    // Only the shape counts, so a curve of half the height is the same curve.
    const ShutterCurve low = ShutterCurve::points({{3, 0.5}, {7, 0.5}}, "low");
    EXPECT_TRUE(low.is_box());
    EXPECT_EQ(low.fingerprint(), box.fingerprint());
}

TEST(ShutterCurves, ATriangleHasItsClosedForm) {
    const ShutterCurve triangle = ShutterCurve::triangle();
    EXPECT_FALSE(triangle.is_box());
    EXPECT_NE(triangle.fingerprint(), ShutterCurve::box().fingerprint());
    for (int i = 0; i <= 1000; ++i) {
        const double u = i / 1000.0;
        // The accumulated light at t <= 1/2 is 2 t^2. Near the ends, a root increases rounding from 2^-53 to
        // 2^-26.
        const double t = u <= 0.5 ? std::sqrt(u / 2) : 1 - std::sqrt((1 - u) / 2);
        EXPECT_NEAR(triangle.time(u), t, i == 1000 ? 2e-8 : 1e-13);
        EXPECT_NEAR(triangle.density(u), u <= 0.5 ? 4 * u : 4 * (1 - u), 1e-14);
        EXPECT_NEAR(triangle.light(u), u <= 0.5 ? 2 * u * u : 1 - 2 * (1 - u) * (1 - u), 1e-15);
    }
}

// The integral of the density over [0, t] by the trapezium rule between the kinks, where it is exact.
double light(const ShutterCurve& c, const std::vector<double>& kinks, double t) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < kinks.size(); ++i) {
        const double a = kinks[i], b = std::min(kinks[i + 1], t);
        if (!(b > a)) break;
        // Uses the middle of the interval, because the density has two values at a jump.
        sum += (b - a) * c.density(0.5 * (a + b));
    }
    return sum;
}

TEST(ShutterCurves, TimeIsTheInverseOfTheLightThatHasCome) {
    const std::vector<std::vector<std::pair<double, double>>> all{
        {{0, 0}, {0.5, 1}, {1, 0}},
        {{-2, 0.1}, {-1, 3}, {0, 0.5}, {5, 0.7}},
        {{0, 1}, {0.25, 0}, {0.75, 0}, {1, 2}},          // closed in between
        {{0, 0}, {0.2, 0}, {0.4, 1}, {0.9, 0}, {1, 0}},  // closed at both ends
        {{0, 0}, {1e-6, 1}, {1 - 1e-6, 1}, {1, 0}},      // steep flanks
        {{0, 1e-12}, {0.5, 1e12}, {1, 1e-12}},           // extreme heights
        {{1e9, 1}, {1e9 + 1, 0.2}},
    };
    for (std::size_t which = 0; which < all.size(); ++which) {
        const auto& points = all[which];
        const ShutterCurve c = ShutterCurve::points(points, "test");
        std::vector<double> kinks;
        for (const auto& [t, h] : points)
            kinks.push_back((t - points.front().first) / (points.back().first - points.front().first));
        EXPECT_NEAR(light(c, kinks, 1), 1, 1e-9) << which;
        double before = 0;
        for (int i = 0; i <= 5000; ++i) {
            const double u = i / 5000.0, t = c.time(u);
            ASSERT_TRUE(t >= before && t <= 1) << which << " " << u << " " << t;
            before = t;
            // The light at t must be u again. An error of 2^-52 in t changes it by the density times that;
            // densities are below 1e7 here.
            EXPECT_NEAR(light(c, kinks, t), u, 1e-9) << which;
            EXPECT_NEAR(c.light(t), light(c, kinks, t), 1e-12) << which;
        }
        EXPECT_GE(c.time(0), 0);
        EXPECT_EQ(c.light(0), 0);
        EXPECT_EQ(c.light(1), 1);
    }
    // No instant is in an interval in which the shutter is closed.
    const ShutterCurve gap = ShutterCurve::points(all[2], "gap");
    for (int i = 0; i < 1000; ++i) {
        const double t = gap.time((i + 0.5) / 1000);
        EXPECT_TRUE(t < 0.25 || t > 0.75) << t;
        EXPECT_GT(gap.density(t), 0);
    }
}

TEST(ShutterCurves, AStretchOfZerosIsLeftOutAtItsBorders) {
    const ShutterCurve shut_first = ShutterCurve::points({{0, 0}, {0.5, 0}, {1, 1}}, "test");
    for (const double u : {0x1p-24, 0.5, 1 - 0x1p-24}) EXPECT_GE(shut_first.time(u), 0.5);
    EXPECT_NEAR(shut_first.time(0.25), 0.75, 1e-14);  // (2 (t - 1/2))^2 = u
    const ShutterCurve shut_last = ShutterCurve::points({{0, 1}, {0.5, 0}, {1, 0}}, "test");
    for (const double u : {0.0, 0.5, 1 - 0x1p-24, 1.0}) EXPECT_LE(shut_last.time(u), 0.5);
}

class ShutterFile : public testing::Test {
  protected:
    fs::path file(const std::string& text) {
        const fs::path path = folder_.path() / "curve.txt";
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    void refused(const fs::path& path, const std::string& part) {
        expect_refused([&] { (void)ShutterCurve::read(path); }, ExitCode::invalid_input, part, path.string());
    }
    TemporaryFolder folder_;
};

TEST_F(ShutterFile, CommentsBlanksCommasAndDosLineEnds) {
    const auto expected = ShutterCurve::points({{0, 0}, {0.25, 1}, {1, 0.5}}, "test").fingerprint();
    for (const char* text :
         {"0 0\n0.25 1\n1 0.5\n", "# time, transmission\n0, 0\n\n0.25,1 # open\n   \n1 , 0.5",
          "0;0\r\n0.25\t1\r\n1;0.5\r\n", "#\n  0 0 #x\n2.5e-1 1e0\n1 .5\n",
          "\xEF\xBB\xBF#\n0 0\n.25 1\n1 .5\n"}) {
        EXPECT_EQ(ShutterCurve::read(file(text)).fingerprint(), expected) << text;
    }
}

TEST_F(ShutterFile, ErrorsNameTheLine) {
    refused(file("0 0\n0.5 nan\n1 0\n"), ":2: not a finite number (got 'nan'");
    refused(file("0 0\n\n# x\ninf 1\n"), ":4: not a finite number (got 'inf'");
    refused(file("0 0\n1 1e999\n"), ":2: not a finite number (got '1e999'");
    refused(file("0 0\n0.5 1x\n1 0\n"), ":2: not a finite number (got '1x'");
    refused(file("time light\n0 0\n1 1\n"), ":1: not a finite number (got 'time'");
    refused(file("0 0\n\033[31mred 1\n"), ":2: not a finite number (got '?[31mred'");
    refused(file("0 0\n0.5\n1 0\n"), ":2: got 1 numbers");
    refused(file("0 0\n0.5 1 2\n1 0\n"), ":2: got 3 numbers");
}

TEST_F(ShutterFile, WhatIsNoCurveIsRefused) {
    refused(file("0 0\n0.5 1\n0.5 0\n"), "times do not grow (got 0.5 at point 3)");
    refused(file("0 0\n1 1\n0.5 1\n"), "times do not grow (got 0.5 at point 3)");
    refused(file("0 0\n0.5 -0.1\n1 0\n"), "transmission out of range (got -0.1 at point 2");
    refused(file("0 0\n0.5 0\n1 0\n"), "never opens");
    refused(file("0 1\n"), "too few points (got 1");
    refused(file(""), "too few points (got 0");
    refused(file("# nothing\n\n"), "too few points (got 0");
    refused(file("-1e308 1\n1e308 1\n"), "expected");  // the duration of the exposure overflows
    refused(folder_.path(), "cannot read");
    refused(folder_.path() / "missing.txt", "cannot read");
}

TEST_F(ShutterFile, AMillionPointsAreTheMost) {
    std::string text;
    text.reserve(16'000'000);
    for (int i = 0; i < 1'000'000; ++i) text.append(std::to_string(i)).append(" 1\n");
    const ShutterCurve c = ShutterCurve::read(file(text));
    // Tolerance: a sum of a million terms of 1e-6, each with a rounding of up to 2^-53.
    for (const double u : {0.1, 0.5, 0.9}) EXPECT_NEAR(c.time(u), u, 1e6 * 0x1p-53);
    text.append("1000000 1\n");
    refused(file(text), ":1000001: too many points");
}

}  // namespace
}  // namespace postlens::test::shutter_curve_test
