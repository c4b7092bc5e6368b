#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "core/error.h"
#include "lens/aperture_response.h"
#include "lens/outline_rows.h"

namespace postlens::test::aperture_test {
namespace {

using glm::dmat2;
using glm::dvec2;

constexpr PixelWindow everywhere{-500, 500, -500, 500};

double sum_of(const ResponseGrid& grid) {
    double sum = 0;
    for (const double share : grid.share) {
        EXPECT_GE(share, 0);
        sum += share;
    }
    return sum;
}

double value(const ResponseGrid& grid, int x, int y) {
    const int i = x - grid.x_begin, j = y - grid.y_begin;
    return i >= 0 && i < grid.width && j >= 0 && j < grid.height ? grid.at(i, j) : 0;
}

dvec2 centroid(const ResponseGrid& grid) {
    dvec2 sum(0);
    for (int j = 0; j < grid.height; ++j) {
        for (int i = 0; i < grid.width; ++i)
            sum += grid.at(i, j) * dvec2(grid.x_begin + i + 0.5, grid.y_begin + j + 0.5);
    }
    return sum / sum_of(grid);
}

/// A letter F, which changes when it is mirrored or rotated.
AperturePicture letter() {
    const char* rows[] = {"#####", "#....", "####.", "#....", "#....", "#....", "#...."};
    AperturePicture out{5, 7, {}};
    for (const char* row : rows) {
        for (int x = 0; x < 5; ++x) out.light.push_back(row[x] == '#' ? 1 : 0);
    }
    return out;
}

/// Largest difference of two responses in a pixel, relative to the mean value of the lit pixels.
double difference(const ResponseGrid& a, const ResponseGrid& b, const PixelWindow& window) {
    double most = 0;
    std::size_t lit = 0;
    for (int y = window.y_begin; y < window.y_end; ++y) {
        for (int x = window.x_begin; x < window.x_end; ++x) {
            most = std::max(most, std::abs(value(a, x, y) - value(b, x, y)));
            if (value(b, x, y) > 0) ++lit;
        }
    }
    return most * static_cast<double>(lit);
}

// The points that sample() draws transmit light, and the points that transmit light cover the aperture's
// area.
TEST(Aperture, TransmitsWhereItIsSampled) {
    Impulse narrow;
    narrow.squeeze = 2;
    for (const Aperture& aperture :
         {Aperture(Impulse{}), Aperture(narrow), Aperture(parse_impulse("--impulse", "polygon:5:20:0.3")),
          Aperture(parse_impulse("--impulse", "image:x.png"), letter())}) {
        constexpr int n = 64, grid = 1000;
        for (int k = 0; k < n * n; ++k) {
            // Not on the rim, which rounding may miss.
            const dvec2 q = aperture.sample((k % n + 0.5) / n, (k / n + 0.5) / n);
            if (aperture.picture() || glm::length(q) < 0.7) {
                EXPECT_EQ(aperture.transmittance(q), 1);
            }
        }
        double lit = 0;
        for (int k = 0; k < grid * grid; ++k)
            lit += aperture.transmittance((dvec2(k % grid, k / grid) + 0.5) * (2.4 / grid) - 1.2);
        const double right =
            aperture.picture() ? 14.0 / 35 * 4 * 5 / 7 : area(aperture.outline(dvec2(0), 1e-6));
        EXPECT_NEAR(lit * (2.4 / grid) * (2.4 / grid), right, 0.005);
    }
}

TEST(Impulse, WordsBecomeSettingsAndBack) {
    const Impulse p = parse_impulse("--impulse", "polygon:7:12.5:0.25");
    EXPECT_EQ(p.kind, ImpulseKind::polygon);
    EXPECT_EQ(p.blades, 7);
    EXPECT_EQ(p.rotation_deg, 12.5);
    EXPECT_EQ(p.roundness, 0.25);
    EXPECT_EQ(parse_impulse("--impulse", "diffraction:450,550.5").wavelengths_nm,
              (std::vector<double>{450, 550.5}));
    EXPECT_EQ(parse_impulse("--impulse", "image:a:b.png").file, "a:b.png");
    EXPECT_EQ(parse_impulse("--impulse", "lens:x.toml").kind, ImpulseKind::lens);
    for (const char* text :
         {"disc", "polygon:5:0:1", "diffraction", "diffraction:500", "image:k.exr", "lens:l.zmx"})
        EXPECT_EQ(impulse_text(parse_impulse("--impulse", text)), text);
    for (const char* text : {"", "disk", "disc:1", "polygon", "polygon:", "polygon:2", "polygon:65",
                             "polygon:6.5", "polygon:6:x", "polygon:6:0:1.5", "polygon:6:0:0:0",
                             "polygon:nan", "diffraction:", "diffraction:-1", "diffraction:500,",
                             "diffraction:nan", "image:", "image", "lens:"}) {
        EXPECT_THROW((void)parse_impulse("--impulse", text), Error) << text;
    }
}

TEST(Impulse, ModifiersAreChecked) {
    const double nan = std::nan("");
    for (const Impulse& i :
         {Impulse{.squeeze = 0}, Impulse{.squeeze = nan}, Impulse{.squeeze = 11}, Impulse{.cats_eye = -0.1},
          Impulse{.cats_eye = 2}, Impulse{.spherical = nan}, Impulse{.spherical = 11},
          Impulse{.kind = ImpulseKind::diffraction, .squeeze = 2},
          Impulse{.kind = ImpulseKind::lens, .cats_eye = 0.5}})
        EXPECT_THROW(check_impulse(i), Error) << impulse_text(i);
    check_impulse({.kind = ImpulseKind::polygon, .squeeze = 2, .cats_eye = 1, .spherical = -0.1});
}

// Samples of the aperture are uniform: the fraction of them left of a line equals the area left of it.
TEST(Aperture, SamplesAreEven) {
    constexpr int n = 400;
    for (const Impulse& i :
         {Impulse{}, Impulse{.kind = ImpulseKind::polygon, .blades = 5, .rotation_deg = 20},
          Impulse{.kind = ImpulseKind::polygon, .blades = 3, .roundness = 0.5}, Impulse{.squeeze = 2}}) {
        const Aperture aperture(i);
        const Outline rim = aperture.outline(dvec2(0), 1e-6);
        const Outline left{{-5, -5}, {-0.2, -5}, {0.1, 5}, {-5, 5}};
        const double expected = area(intersection(rim, left)) / area(rim);
        int count = 0;
        for (int k = 0; k < n * n; ++k) {
            const dvec2 q = aperture.sample((k % n + 0.5) / n, (k / n + 0.5) / n);
            if (q.x < -0.2 + 0.3 * (q.y + 5) / 10) ++count;
        }
        // There are n x n cells, of which a line crosses at most about 4 n.
        EXPECT_NEAR(static_cast<double>(count) / n / n, expected, 4.0 / n) << impulse_text(i);
    }
}

TEST(Aperture, PictureSamplesFollowItsLight) {
    const Aperture aperture({.kind = ImpulseKind::picture, .file = "F"}, letter());
    EXPECT_NEAR(aperture.half_extent().x, 5.0 / 7, 1e-15);
    EXPECT_EQ(aperture.half_extent().y, 1);
    constexpr int n = 280;
    int top = 0, dark = 0;
    for (int k = 0; k < n * n; ++k) {
        const dvec2 q = aperture.sample((k % n + 0.5) / n, (k / n + 0.5) / n);
        if (q.y < -1 + 2.0 / 7) ++top;
        if (q.x > -3.0 / 7 && q.y > -1.0 / 7) ++dark;
    }
    EXPECT_NEAR(static_cast<double>(top) / n / n, 5.0 / 14, 2.0 / n);
    EXPECT_EQ(dark, 0);
}

// Two unit discs at distance d overlap in the fraction (2 acos(d/2) - d/2 sqrt(4 - d^2)) / pi of one disc.
TEST(Aperture, CatsEyeLosesWhatTheSecondRimCutsOff) {
    const Aperture aperture({.cats_eye = 0.8});
    EXPECT_EQ(aperture.transmission(dvec2(0)), 1);
    for (const dvec2 field : {dvec2(0.3, 0), dvec2(0.5, -0.5), dvec2(0, 0.9), dvec2(-0.8, 0.6)}) {
        const double d = 0.8 * glm::length(field);
        const double expected = (2 * std::acos(d / 2) - d / 2 * std::sqrt(4 - d * d)) / std::numbers::pi;
        EXPECT_NEAR(aperture.transmission(field), expected, 1e-3);
        const Outline rim = aperture.outline(field, 1e-5);
        EXPECT_NEAR(area(rim) / std::numbers::pi, expected, 1e-4);
        for (const dvec2& p : rim) EXPECT_LE(glm::length(p + 0.8 * field), 1 + 1e-4);
    }
    EXPECT_EQ(Aperture({}).transmission({0.7, 0.7}), 1);
}

// Behind the focus the response has the orientation of the aperture in the image; before the focus it is
// upside down.
TEST(ApertureResponse, OrientationFollowsTheSideOfTheFocus) {
    const Aperture aperture({.kind = ImpulseKind::picture, .file = "F"}, letter());
    const ResponseGrid behind = dense_response(aperture, {.map_px = dmat2(7)}, everywhere),
                       before = dense_response(aperture, {.map_px = dmat2(-7)}, everywhere);
    // A cell of the letter is 2 px wide: its top row covers rows -7 and -6, its stem columns -5 and -4.
    for (int x = -5; x < 5; ++x) {
        EXPECT_NEAR(value(behind, x, -7), 1.0 / 56, 1e-12);
        EXPECT_NEAR(value(before, x, 6), 1.0 / 56, 1e-12);
    }
    for (int y = -7; y < 7; ++y) {
        EXPECT_NEAR(value(behind, -5, y), 1.0 / 56, 1e-12);
        EXPECT_NEAR(value(before, 4, y), 1.0 / 56, 1e-12);
        EXPECT_NEAR(value(behind, 4, y), y < -5 ? 1.0 / 56 : 0, 1e-12);
    }
    EXPECT_NEAR(sum_of(behind), 1, 1e-12);
}

TEST(ApertureResponse, RingsAndTheOutlineAgree) {
    for (const Impulse& i :
         {Impulse{}, Impulse{.kind = ImpulseKind::polygon, .blades = 5, .rotation_deg = 20},
          Impulse{.kind = ImpulseKind::polygon, .blades = 6, .roundness = 0.5, .squeeze = 1.5},
          Impulse{.cats_eye = 0.7}}) {
        const Aperture aperture(i);
        const ApertureImage image{
            .map_px = dmat2(9.3, 1.1, -0.4, 8.2), .field = {0.5, -0.6}, .centre_px = {0.3, 0.9}};
        ASSERT_TRUE(is_even(aperture, image));
        const ResponseGrid dense = dense_response(aperture, image, everywhere);
        EXPECT_NEAR(sum_of(dense), 1, 1e-9);
        const OutlineRows rows(image_outline(aperture, image));
        for (int y = rows.y_begin(); y < rows.y_end(); ++y) {
            CoverageSpan span;
            rows.row(y, span);
            std::size_t edge = 0;
            for (int x = span.x_begin; x < span.x_end; ++x) {
                const bool inner = x >= span.inner_begin && x < span.inner_end;
                const double expected = inner ? rows.inner_share() : span.edge_share[edge++];
                // The chords of the rings are within 0.02 px of the rim, of which a pixel holds at most 2 px.
                EXPECT_NEAR(value(dense, x, y), expected, 0.04 * rows.inner_share())
                    << impulse_text(i) << ": " << x << ", " << y;
            }
        }
    }
}

// Polygons with corners on and next to the borders of pixels, and with sides that are horizontal except for
// the last bit.
TEST(ApertureResponse, KeepsAllLightWhereCornersMeetPixels) {
    for (int blades = 3; blades < 13; ++blades) {
        const Aperture aperture({.kind = ImpulseKind::polygon, .blades = blades});
        for (const double radius : {0.5, 1.0, 9.0, 17.5, -9.0, -17.5}) {
            for (const double phase : {0.0, 0.25, 0.5}) {
                const ApertureImage image{.map_px = dmat2(radius), .centre_px = {phase, 0.5 - phase}};
                const ResponseGrid dense = dense_response(aperture, image, everywhere);
                EXPECT_NEAR(sum_of(dense), 1, 1e-9) << blades << ", " << radius << ", " << phase;
                const OutlineRows rows(image_outline(aperture, image));
                double sum = 0;
                for (int y = rows.y_begin(); y < rows.y_end(); ++y) {
                    CoverageSpan span;
                    rows.row(y, span);
                    sum += (span.inner_end - span.inner_begin) * rows.inner_share();
                    for (const double share : span.edge_share) sum += share;
                }
                EXPECT_NEAR(sum, 1, 1e-9) << blades << ", " << radius << ", " << phase;
            }
        }
    }
}

// Energy within a radius: the fraction of the aperture's zones, of area 2 rho d rho, that map into it.
double encircled(double c, double s, double radius) {
    constexpr int n = 20000;
    double sum = 0;
    for (int k = 0; k < n; ++k) {
        const double rho = (k + 0.5) / n;
        if (std::abs(c * rho + s * rho * rho * rho) <= radius) sum += 2 * rho / n;
    }
    return sum;
}

TEST(ApertureResponse, SphericalAberrationPutsEveryZoneWhereItBelongs) {
    const Aperture aperture({.spherical = 0.1});
    for (const auto& [c, s] : {std::pair{20.0, 10.0}, {-20.0, 10.0}, {-12.0, 20.0}, {0.0, 16.0}}) {
        const ResponseGrid grid = dense_response(
            aperture, {.map_px = dmat2(c), .spherical_px = s, .centre_px = {0.5, 0.5}}, everywhere);
        EXPECT_NEAR(sum_of(grid), 1, 1e-9);
        for (const double radius : {3.0, 6.5, 9.0, 14.0, 19.0, 31.0}) {
            double inside = 0;
            for (int j = 0; j < grid.height; ++j) {
                for (int i = 0; i < grid.width; ++i) {
                    const double distance = std::hypot(grid.x_begin + i, grid.y_begin + j);
                    if (distance <= radius) inside += grid.at(i, j);
                }
            }
            // Pixels along the circle count as wholly inside or outside, an error of about half a pixel in
            // the radius.
            EXPECT_GE(inside, encircled(c, s, radius - 0.8) - 1e-3) << c << ", " << s << ": " << radius;
            EXPECT_LE(inside, encircled(c, s, radius + 0.8) + 1e-3) << c << ", " << s << ": " << radius;
        }
    }
}

TEST(ApertureResponse, FarthestLightIsThatOfTheZoneThatReachesFarthest) {
    for (const double squeeze : {0.5, 1.0, 3.0}) {
        const Aperture aperture({.squeeze = squeeze});
        const double rim = std::max(1.0, 1 / squeeze);
        for (const double radius : {-7.0, -0.3, 0.0, 4.0}) {
            for (const double spherical : {-5.0, 0.0, 0.1, 2.0, 30.0}) {
                double expected = 0;
                for (int i = 0; i <= 4096; ++i) {
                    const double zone = rim * i / 4096;
                    expected = std::max(expected, std::abs(radius * zone + spherical * zone * zone * zone));
                }
                EXPECT_NEAR(farthest_light_px(aperture, radius, spherical), expected, 1e-5)
                    << squeeze << " " << radius << " " << spherical;
            }
        }
    }
}

TEST(ApertureResponse, RimIsBrightOnOneSideOfTheFocusAndSoftOnTheOther) {
    const Aperture aperture({.spherical = 0.1});
    const auto profile = [&](double c) {
        const ResponseGrid g = dense_response(
            aperture, {.map_px = dmat2(c), .spherical_px = 6, .centre_px = {0.5, 0.5}}, everywhere);
        return std::pair{value(g, 2, 0), value(g, static_cast<int>(std::abs(c + 6)) - 2, 0)};
    };
    const auto [soft_middle, soft_rim] = profile(30);
    EXPECT_LT(soft_rim, 0.6 * soft_middle);
    const auto [hard_middle, hard_rim] = profile(-30);
    EXPECT_GT(hard_rim, 1.5 * hard_middle);
}

TEST(ApertureResponse, AgreesWithRays) {
    const std::vector<std::pair<Aperture, ApertureImage>> cases{
        {Aperture({.kind = ImpulseKind::picture, .file = "F"}, letter()),
         {.map_px = dmat2(8.3, 1, -2, 7.1), .spherical_px = 2, .centre_px = {0.2, 0.6}}},
        {Aperture({.kind = ImpulseKind::picture, .file = "F", .cats_eye = 0.4}, letter()),
         {.map_px = dmat2(-11), .field = {0.6, 0.3}}},
        {Aperture({.kind = ImpulseKind::polygon, .blades = 5, .spherical = 0.1}),
         {.map_px = dmat2(9), .spherical_px = 5, .centre_px = {0.7, 0.1}}},
        {Aperture({.squeeze = 2, .cats_eye = 0.6, .spherical = 0.1}),
         {.map_px = dmat2(-12), .spherical_px = 3, .field = {0.5, 0.5}}}};
    for (std::size_t k = 0; k < cases.size(); ++k) {
        const auto& [aperture, image] = cases[k];
        const ResponseGrid got = dense_response(aperture, image, everywhere),
                           rays = ray_response(aperture, image, everywhere, 800);
        EXPECT_NEAR(sum_of(got), 1, 1e-9) << k;
        // A pixel holds about 800^2 / 300 = 2100 rays on a grid. Rays along its border of 4 px may be
        // miscounted: 4 / sqrt(2100) = 9 %.
        EXPECT_LT(difference(got, rays, everywhere), 0.12) << k;
        const dvec2 off = centroid(got) - centroid(rays);
        EXPECT_LT(glm::length(off), 0.01) << k;
    }
}

TEST(ApertureResponse, WindowCutsAndNothingElse) {
    const Aperture aperture({.kind = ImpulseKind::polygon, .blades = 5, .spherical = 0.1});
    const ApertureImage image{.map_px = dmat2(20), .spherical_px = 4};
    const PixelWindow window{-7, 12, 3, 30};
    const ResponseGrid whole = dense_response(aperture, image, everywhere),
                       part = dense_response(aperture, image, window);
    EXPECT_EQ(part.x_begin, -7);
    EXPECT_EQ(part.width, 19);
    EXPECT_EQ(part.y_begin, 3);
    for (int y = window.y_begin; y < window.y_end; ++y) {
        for (int x = window.x_begin; x < window.x_end; ++x)
            EXPECT_NEAR(value(part, x, y), value(whole, x, y), 1e-13) << x << ", " << y;
    }
}

TEST(ApertureResponse, NextToNothingIsOnePixel) {
    for (const Impulse& i : {Impulse{.kind = ImpulseKind::polygon, .blades = 3}, Impulse{.spherical = 1}}) {
        const Aperture aperture(i);
        for (const double radius : {0.0, 1e-9, -1e-9}) {
            const ApertureImage image{.map_px = dmat2(radius), .centre_px = {0.5, 0.5}};
            const ResponseGrid grid = dense_response(aperture, image, everywhere);
            EXPECT_NEAR(value(grid, 0, 0), 1, 1e-9);
            const OutlineRows rows(image_outline(aperture, image));
            EXPECT_EQ(rows.y_begin(), 0);
            EXPECT_EQ(rows.y_end(), 1);
        }
    }
    // A singular map turns the aperture into a line.
    const dmat2 flat(5, 0, 0, 0);
    EXPECT_GT(std::abs(glm::determinant(with_area(flat))), 0);
    EXPECT_NEAR(sum_of(dense_response(Aperture({.squeeze = 2}), {.map_px = flat}, everywhere)), 1, 1e-9);
}

}  // namespace
}  // namespace postlens::test::aperture_test
