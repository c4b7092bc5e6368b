#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "lens/focus_geometry.h"
#include "lens/thin_lens.h"

namespace postlens::test::lens_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(ThinLens, ImageDistanceSolvesTheLensEquation) {
    const ThinLens lens{.focal_length_mm = 50, .f_number = 2};
    // The lens equation is 1/F = 1/V + 1/s.
    EXPECT_NEAR(1 / image_distance_mm(lens, 2.0) + 1 / 2000.0, 1 / 50.0, 1e-15);
    EXPECT_EQ(image_distance_mm(lens, infinity), 50);
    EXPECT_TRUE(std::isinf(image_distance_mm(lens, 0.05)));
    EXPECT_LT(image_distance_mm(lens, 0.04), 0);
}

TEST(ThinLens, CircleOfConfusionIsThatOf1981) {
    const ThinLens lens{.focal_length_mm = 50, .f_number = 1.4};
    // The film at V cuts the cone that converges at V_z = F z / (z - F), so C = |V_z - V| D / V_z.
    for (const double z_m : {0.3, 1.0, 4.999, 5.001, 30.0}) {
        const double v_s = image_distance_mm(lens, 5), v_z = image_distance_mm(lens, z_m);
        const double cone_mm = lens.aperture_diameter_mm() * std::abs(v_z - v_s) / v_z;
        EXPECT_NEAR(std::abs(coc_diameter_mm(lens, 5, z_m)), cone_mm, 1e-12) << z_m;
    }
    EXPECT_LT(coc_diameter_mm(lens, 5, 1), 0);
    EXPECT_GT(coc_diameter_mm(lens, 5, 9), 0);
    EXPECT_EQ(coc_diameter_mm(lens, 5, 5), 0);
}

TEST(ThinLens, CircleOfConfusionIsRightAtItsLimits) {
    const ThinLens lens{.focal_length_mm = 50, .f_number = 2};
    // The CoC is F^2 / (n (s - F)) for infinite z, and -F^2 / (n z) for infinite s.
    EXPECT_NEAR(coc_diameter_mm(lens, 2, infinity), 2500.0 / (2 * 1950), 1e-12);
    EXPECT_NEAR(coc_diameter_mm(lens, infinity, 10), -2500.0 / (2 * 10000), 1e-12);
    EXPECT_EQ(coc_diameter_mm(lens, infinity, infinity), 0);
    EXPECT_NEAR(coc_diameter_mm(lens, 2, 1e9), coc_diameter_mm(lens, 2, infinity), 1e-8);
    EXPECT_TRUE(std::isfinite(coc_diameter_mm(lens, 2, 1e-6)));
    EXPECT_EQ(coc_diameter_mm({.focal_length_mm = 50, .f_number = infinity}, 2, 3), 0);
}

TEST(DepthOfField, EqualsThePublishedTables) {
    std::ifstream file(POSTLENS_TEST_DATA "/dof_expected.csv");
    ASSERT_TRUE(file);
    std::string line;
    std::getline(file, line);
    int rows = 0;
    while (std::getline(file, line)) {
        if (line.empty()) continue;
        std::vector<std::string> field;
        std::stringstream stream(line);
        for (std::string f; std::getline(stream, f, ',');) field.push_back(f);
        ASSERT_EQ(field.size(), 9U) << line;
        ASSERT_EQ(field[5], "m");
        const ThinLens lens{.focal_length_mm = std::stod(field[1]), .f_number = std::stod(field[2])};
        const DepthOfField dof = depth_of_field(lens, std::stod(field[4]), std::stod(field[3]));
        // Compares each number to the precision with which it is printed.
        const auto expect = [&](const std::string& printed, double value) {
            if (printed.empty()) return;
            if (printed == "inf") {
                EXPECT_TRUE(std::isinf(value)) << line;
                return;
            }
            const std::size_t point = printed.find('.');
            const double unit = std::pow(10.0, -static_cast<double>(printed.size() - point - 1));
            EXPECT_NEAR(value, std::stod(printed), std::max(unit, 1e-12 * value)) << line;
        };
        expect(field[6], dof.hyperfocal_m);
        expect(field[7], dof.near_m);
        expect(field[8], dof.far_m);
        ++rows;
    }
    EXPECT_EQ(rows, 5);
}

TEST(DepthOfField, LimitsHaveExactlyTheAllowedCircle) {
    const ThinLens lens{.focal_length_mm = 85, .f_number = 1.8};
    const DepthOfField dof = depth_of_field(lens, 3, 0.02);
    EXPECT_NEAR(coc_diameter_mm(lens, 3, dof.near_m), -0.02, 1e-12);
    EXPECT_NEAR(coc_diameter_mm(lens, 3, dof.far_m), 0.02, 1e-12);
}

TEST(DepthOfField, HyperfocalDistance) {
    const ThinLens lens{.focal_length_mm = 50, .f_number = 8};
    const double hyperfocal_m = depth_of_field(lens, 4, 0.03).hyperfocal_m;
    EXPECT_NEAR(hyperfocal_m, (2500 / (8 * 0.03) + 50) / 1000, 1e-12);
    // With the focus at the hyperfocal distance, everything from half of this distance on is sharp.
    const DepthOfField dof = depth_of_field(lens, hyperfocal_m, 0.03);
    EXPECT_TRUE(std::isinf(dof.far_m));
    EXPECT_NEAR(dof.near_m, hyperfocal_m / 2, 1e-12);
    const DepthOfField at_infinity = depth_of_field(lens, infinity, 0.03);
    EXPECT_TRUE(std::isinf(at_infinity.far_m));
    EXPECT_NEAR(at_infinity.near_m, hyperfocal_m - 0.05, 1e-12);
}

TEST(DepthOfField, LegalLimitsAreExact) {
    const ThinLens pinhole{.focal_length_mm = 50, .f_number = infinity};
    EXPECT_EQ(depth_of_field(pinhole, 2, 0.03).near_m, 0);
    EXPECT_TRUE(std::isinf(depth_of_field(pinhole, 2, 0.03).far_m));
    const DepthOfField none = depth_of_field({.focal_length_mm = 50, .f_number = 2}, 2, 0);
    EXPECT_EQ(none.near_m, 2);
    EXPECT_EQ(none.far_m, 2);
}

constexpr Film film{.distance_mm = 50, .pixel_pitch_mm = 36.0 / 960};

TEST(FocusGeometry, KeepsTheViewOfTheTrace) {
    const FocusGeometry g = focus_geometry({.focal_length_mm = 85, .f_number = 1.4}, 5, Framing::keep, film);
    EXPECT_EQ(g.zoom, 1);
    // The CoC is (d / pitch) (F / n) |1/s - 1/z|, with F in metres.
    EXPECT_NEAR(g.coc_diameter_px(1 / 1.5), 50 / (36.0 / 960) * (0.085 / 1.4) * (1 / 5.0 - 1 / 1.5), 1e-12);
    EXPECT_GT(g.coc_diameter_px(0), 0);
    EXPECT_EQ(g.coc_diameter_px(0.2), 0);
}

TEST(FocusGeometry, BreathingHasTheCircleOf1981OnTheFilm) {
    const ThinLens lens{.focal_length_mm = 50, .f_number = 2};
    const FocusGeometry g = focus_geometry(lens, 1.2, Framing::breathing, film);
    for (const double z_m : {0.4, 1.0, 3.0, infinity}) {
        EXPECT_NEAR(g.coc_diameter_px(1 / z_m) * film.pixel_pitch_mm, coc_diameter_mm(lens, 1.2, z_m), 1e-12);
    }
    EXPECT_NEAR(g.zoom, image_distance_mm(lens, 1.2) / 50, 1e-15);
}

TEST(FocusGeometry, LensFramingPutsTheFilmAtTheFocalLength) {
    const FocusGeometry g = focus_geometry({.focal_length_mm = 100, .f_number = 2}, 5, Framing::lens, film);
    EXPECT_NEAR(g.zoom, 2, 1e-15);
    EXPECT_NEAR(g.gain_px, 100 / (36.0 / 960), 1e-9);
    // The CoC on a film at F is smaller by s / (s - F) than on a film at V.
    const FocusGeometry v =
        focus_geometry({.focal_length_mm = 100, .f_number = 2}, 5, Framing::breathing, film);
    EXPECT_NEAR(v.coc_diameter_px(1) / g.coc_diameter_px(1), 5 / 4.9, 1e-12);
}

TEST(FocusGeometry, FiniteWhereverItIsDefined) {
    for (const double s_m : {0.02, 0.05, 1.0, infinity}) {
        const FocusGeometry g =
            focus_geometry({.focal_length_mm = 50, .f_number = 1.4}, s_m, Framing::keep, film);
        for (const double z_m : {1e-6, 0.02, 0.05, 1.0, infinity}) {
            EXPECT_TRUE(std::isfinite(g.coc_diameter_px(1 / z_m))) << s_m << " " << z_m;
        }
        EXPECT_EQ(g.coc_diameter_px(1 / s_m), 0) << s_m;
    }
    EXPECT_EQ(focus_geometry({.focal_length_mm = 50, .f_number = infinity}, 1, Framing::keep, film)
                  .aperture_radius_m,
              0);
}

std::string refusal(const ThinLens& lens, double s_m, Framing framing) {
    try {
        (void)focus_geometry(lens, s_m, framing, film);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::wrong_arguments);
        return e.what();
    }
    return {};
}

TEST(FocusGeometry, RefusesWhatIsOutOfRangeWithTheReason) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double f : {0.0, -50.0, nan, infinity}) {
        EXPECT_NE(refusal({.focal_length_mm = f, .f_number = 2}, 1, Framing::keep).find("focal length"),
                  std::string::npos);
    }
    for (const double n : {0.0, -1.0, nan}) {
        EXPECT_NE(refusal({.focal_length_mm = 50, .f_number = n}, 1, Framing::keep).find("f-number"),
                  std::string::npos);
    }
    for (const double s : {0.0, -1.0, nan}) {
        EXPECT_NE(refusal({.focal_length_mm = 50, .f_number = 2}, s, Framing::keep).find("focus distance"),
                  std::string::npos);
    }
    const ThinLens lens{.focal_length_mm = 50, .f_number = 2};
    EXPECT_EQ(refusal(lens, 0.03, Framing::keep), "");
    for (const Framing framing : {Framing::lens, Framing::breathing}) {
        EXPECT_NE(refusal(lens, 0.03, framing).find("within the focal length"), std::string::npos);
        EXPECT_NE(refusal(lens, 0.05, framing).find("expected more than 0.05 m"), std::string::npos);
    }
    EXPECT_THROW((void)focus_geometry(lens, 1, Framing::keep, {.distance_mm = 0, .pixel_pitch_mm = 1}),
                 Error);
    EXPECT_THROW((void)focus_geometry(lens, 1, Framing::keep, {.distance_mm = 50, .pixel_pitch_mm = 0}),
                 Error);
}

}  // namespace
}  // namespace postlens::test::lens_test
