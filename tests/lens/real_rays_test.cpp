// Exact rays through lenses: CODE V's listing of real rays, and closed forms of simple surfaces.
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/text.h"
#include "lens/prescription/prescription.h"
#include "lens/traced/traced_lens.h"
#include "tests/lens/lens_files.h"

namespace postlens::test::real_rays_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double infinite_m = std::numeric_limits<double>::infinity();

double tangent(double deg) {
    return std::tan(deg * std::numbers::pi / 180);
}

/// One ray of the listing's ANA: its points on surfaces 1 to 11 and its tangents after them.
struct ListedRay {
    double object_tangent = 0;
    std::array<dvec3, 11> at{};
    std::array<dvec2, 11> tangent{};
};
/// A row of the listing's "RELATIVE STOP COORDINATES - RAY ABERRATIONS".
struct ListedAberration {
    double object_tangent = 0;
    dvec2 stop{0}, error_mm{0};
};
struct Listing {
    std::vector<ListedRay> rays;
    std::vector<ListedAberration> aberrations;
};

std::vector<double> numbers_of(const std::string& line) {
    std::vector<double> out;
    std::istringstream words(line);
    std::string word;
    while (words >> word) {
        const auto value = parse_number(word);
        if (!value) return {};
        out.push_back(*value);
    }
    return out;
}

Listing read_listing() {
    Listing out;
    std::ifstream in(POSTLENS_TEST_DATA "/lens/rayoptics_ag_dblgauss.lis");
    std::string line;
    while (std::getline(in, line) && line.rfind("ANA> go", 0) != 0) {
    }
    double field = 0;
    while (std::getline(in, line)) {
        if (line.rfind(" OBJ", 0) == 0) {
            field = numbers_of(line.substr(4))[4];
            ListedRay ray;
            ray.object_tangent = field;
            for (std::size_t i = 0; i < 11 && std::getline(in, line); ++i) {
                const auto v = numbers_of(line);
                EXPECT_EQ(v.size(), 9U) << line;
                ray.at[i] = {v[1], v[2], v[3]};
                ray.tangent[i] = {v[4], v[5]};
            }
            out.rays.push_back(ray);
        } else if (const auto v = numbers_of(line); v.size() == 5 || v.size() == 6) {
            // The row of the chief ray has two zeros as its stop point, and its height instead of an
            // aberration.
            if (v[0] != 0 || v[1] != 0) out.aberrations.push_back({field, {v[0], v[1]}, {v[2], v[3]}});
        }
    }
    return out;
}

TEST(RealRays, PointsOfCodeVListing) {
    const Prescription lens = published_lens("rayoptics_ag_dblgauss.seq");
    const LensStack stack(lens, lens.wavelength_nm, HUGE_VAL);
    const Listing listing = read_listing();
    ASSERT_EQ(listing.rays.size(), 9U);
    for (const ListedRay& listed : listing.rays) {
        const double t = listed.object_tangent == 0 ? 0 : tangent(listed.object_tangent < 0.2 ? 10 : 14);
        EXPECT_NEAR(t, listed.object_tangent, 0.6e-6);
        LensRay ray{listed.at[0], glm::normalize(dvec3(0, t, 1))};
        std::array<dvec3, 11> hits{};
        ASSERT_TRUE(stack.forward(ray, Apertures::ignored, hits).passes());
        for (std::size_t i = 0; i < 11; ++i) {
            const dvec3 local = hits[i] - dvec3(0, 0, stack.vertex_z_mm(i));
            // Points and the ray's origin are listed to six decimals; the lens magnifies the rounding of the
            // origin by less than 2.
            for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(local[axis], listed.at[i][axis], 2e-6) << i + 1;
        }
        EXPECT_NEAR(ray.direction.x / ray.direction.z, listed.tangent[10].x, 1e-6);
        EXPECT_NEAR(ray.direction.y / ray.direction.z, listed.tangent[10].y, 1e-6);
    }
}

TEST(RealRays, TransverseErrorsOfCodeVListing) {
    const Prescription lens = published_lens("rayoptics_ag_dblgauss.seq");
    const TracedLens traced(lens);
    EXPECT_NEAR(traced.film_distance_mm(), 61.4875364179821 - 0.4002686453541377, 1e-12);
    const Listing listing = read_listing();
    EXPECT_EQ(listing.aberrations.size(), 28U);
    // Rows of a fan are at fractions of the pupil. The design's vignetting factors narrow the pupil: VUY 0.2
    // and VLY 0.25 at 10 degrees, both 0.4 at 14 degrees.
    for (const ListedAberration& row : listing.aberrations) {
        const double deg = row.object_tangent == 0 ? 0 : row.object_tangent < 0.2 ? 10 : 14;
        const dvec2 field(0, -tangent(deg));  // rays of the listing's field come from below the axis
        const dvec2 aim = traced.aim_at_stop(HUGE_VAL, field).value();
        const bool along_x = row.stop.x != 0;
        const double reach = along_x ? row.stop.x : row.stop.y;
        // The stop coordinates are rounded to two decimals and distorted by the pupil's aberration. The pupil
        // coordinates are the nearest multiples of 1/5.
        const double edge = along_x || deg == 0 ? 1 : deg == 14 ? 0.6 : reach > 0 ? 0.8 : 0.75;
        const double fraction = std::round(reach / edge * 5) / 5 * edge;
        const dvec2 pupil = aim + 25.0 * (along_x ? dvec2(fraction, 0) : dvec2(0, fraction));
        LensRay ray = traced.object_ray(HUGE_VAL, field, pupil),
                chief = traced.object_ray(HUGE_VAL, field, aim);
        ASSERT_TRUE(traced.stack().forward(ray, Apertures::ignored).passes());
        ASSERT_TRUE(traced.stack().forward(chief, Apertures::ignored).passes());
        const dvec2 error = traced.on_film(ray) - traced.on_film(chief);
        EXPECT_NEAR(error.x, row.error_mm.x, 1.5e-6) << deg << " " << row.stop.x << " " << row.stop.y;
        EXPECT_NEAR(error.y, row.error_mm.y, 1.5e-6) << deg << " " << row.stop.x << " " << row.stop.y;
    }
    // Heights and distortions of the chief rays, from the text of the listing.
    const auto height = [&](double deg) {
        LensRay chief = traced.object_ray(HUGE_VAL, {0, -tangent(deg)},
                                          *traced.aim_at_stop(HUGE_VAL, {0, -tangent(deg)}));
        EXPECT_TRUE(traced.stack().forward(chief).passes());
        return traced.on_film(chief).y;
    };
    EXPECT_NEAR(height(10), 17.485856, 1e-6);
    EXPECT_NEAR(height(14), 24.588739, 1e-6);
}

// A plane-parallel plate displaces a ray sideways by t sin(i) (1 - cos(i) / (n cos(i'))).
Prescription plate(double n, double thickness) {
    Prescription lens;
    lens.surfaces.resize(3);
    lens.surfaces[0].glass = Glass::constant(n);
    lens.surfaces[0].thickness_mm = thickness;
    lens.surfaces[2].is_stop = true;
    lens.surfaces[2].clear_radius_mm = 100;
    return lens;
}

TEST(RealRays, APlateShiftsARay) {
    const LensStack stack(plate(1.6, 7), d_line_nm, HUGE_VAL);
    const double i = 0.6, inside = std::asin(std::sin(i) / 1.6);
    LensRay ray{dvec3(0), {0, std::sin(i), std::cos(i)}};
    ASSERT_TRUE(stack.forward(ray).passes());
    EXPECT_NEAR(ray.direction.y, std::sin(i), 1e-15);
    EXPECT_NEAR(ray.origin.y, 7 * std::tan(inside), 1e-14);
}

TEST(RealRays, ASurfaceIsMetFromAfar) {
    // A ray parallel to the axis hits a glass ball, 10 000 km behind the lens's front, at half of its radius.
    // The sine of the angle of incidence is 0.5, and Snell's law gives the refraction.
    const double radius = 0.02, n = 1.5;
    Prescription lens;
    lens.surfaces.resize(2);
    lens.surfaces[0].thickness_mm = 1e10;
    lens.surfaces[1].curvature_per_mm = 1 / radius;
    lens.surfaces[1].glass = Glass::constant(n);
    const LensStack stack(lens, d_line_nm, HUGE_VAL);
    LensRay ray{{0, 0.5 * radius, 0}, {0, 0, 1}};
    ASSERT_TRUE(stack.forward(ray).passes());
    EXPECT_NEAR(ray.direction.y, -std::sin(std::asin(0.5) - std::asin(0.5 / n)), 1e-15);
    EXPECT_NEAR(glm::length(ray.direction), 1, 1e-15);
    LensRay beside{{0, 1.01 * radius, 0}, {0, 0, 1}};
    EXPECT_EQ(stack.forward(beside).fate, RayFate::misses);
}

TEST(RealRays, ASurfaceSmallerThanRounding) {
    // A surface with a radius of 1e-20 mm, 2.313 mm behind the first surface. The radius is smaller than the
    // error of this distance if the direction's length is 1 only up to rounding.
    Prescription lens;
    lens.surfaces.resize(2);
    lens.surfaces[0].thickness_mm = 2.313;
    lens.surfaces[1].curvature_per_mm = -1.44e20;
    lens.surfaces[1].glass = Glass::constant(1.57);
    const LensStack stack(lens, d_line_nm, HUGE_VAL);
    for (int i = -20; i <= 20; ++i) {
        LensRay ray{{0, 0, 0}, {0, 0, 1 + i * 2.22e-16}};
        ASSERT_TRUE(stack.forward(ray).passes());
        EXPECT_NEAR(ray.direction.z, 1, 1e-14) << i;
    }
}

TEST(RealRays, ABallIsPassedOnItsAxisAndBesideIt) {
    // The second surface's sphere begins at the first surface's vertex, so that a ray along the axis starts
    // on this sphere. A ray at distance y from the centre leaves at the same distance and turned by twice the
    // angle of one refraction: it crosses the axis y / sin(turn) behind the centre.
    const double radius = 10, n = 1.5;
    Prescription lens;
    lens.surfaces.resize(2);
    lens.surfaces[0].curvature_per_mm = 1 / radius;
    lens.surfaces[0].glass = Glass::constant(n);
    lens.surfaces[0].thickness_mm = 2 * radius;
    lens.surfaces[1].curvature_per_mm = -1 / radius;
    const LensStack stack(lens, d_line_nm, HUGE_VAL);
    for (const double direction : {1.0, -1.0}) {
        for (const double y : {0.0, 1e-12, 1e-7, 1e-4, 0.1, 5.0}) {
            LensRay ray{{0, y, radius}, {0, 0, direction}};
            ASSERT_TRUE((direction > 0 ? stack.forward(ray) : stack.backward(ray)).passes()) << y;
            const double turn = 2 * (std::asin(y / radius) - std::asin(y / radius / n));
            EXPECT_NEAR(ray.direction.y, -std::sin(turn), 1e-15) << y;
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-15) << y;
            EXPECT_NEAR(glm::length(glm::cross(ray.origin - dvec3(0, 0, radius), ray.direction)), y, 1e-14)
                << y;
        }
    }
}

TEST(RealRays, ASurfaceTooSteepForANumber) {
    // A paraboloid with a radius of 1e-200 mm is met at a height of 1e198 mm, where the square of its slope
    // exceeds the largest number. No normal can be given, and the ray does not pass.
    Prescription lens;
    lens.surfaces.resize(1);
    lens.surfaces[0].curvature_per_mm = 1e200;
    lens.surfaces[0].conic = -1;
    lens.surfaces[0].glass = Glass::constant(1.5);
    const LensStack stack(lens, d_line_nm, HUGE_VAL);
    LensRay ray{{0, 0.1, 0}, {0, 0, 1}};
    EXPECT_EQ(stack.forward(ray).fate, RayFate::misses);
}

TEST(RealRays, AConicWithoutSphericalAberration) {
    // The end of a glass rod, shaped as the ellipsoid k = -1/n^2, focuses parallel light in one point at n R
    // / (n - 1) behind its vertex. The rays pass a plane far in front of the focus.
    const double n = 1.5, radius = 20;
    Prescription lens;
    lens.surfaces.resize(2);
    lens.surfaces[0].curvature_per_mm = 1 / radius;
    lens.surfaces[0].conic = -1 / (n * n);
    lens.surfaces[0].glass = Glass::constant(n);
    lens.surfaces[0].clear_radius_mm = 12;
    lens.surfaces[0].is_stop = true;
    lens.surfaces[0].thickness_mm = 59;
    lens.surfaces[1].glass = Glass::constant(n);  // no refraction; the film is in glass
    const LensStack stack(lens, d_line_nm, HUGE_VAL);
    for (const double y : {0.5, 5.0, 11.9}) {
        LensRay ray{{0, y, 0}, {0, 0, 1}};
        ASSERT_TRUE(stack.forward(ray).passes());
        EXPECT_NEAR(ray.at_z(n * radius / (n - 1)).y, 0, 1e-13);
    }
    // A ray beyond the rim of the surface is vignetted.
    LensRay beyond{{0, 12.1, 0}, {0, 0, 1}};
    const RayEnd end = stack.forward(beyond);
    EXPECT_EQ(end.fate, RayFate::vignetted);
    EXPECT_EQ(end.surface, 0U);
}

TEST(RealRays, AnAsphereIsMetWhereItsSagSays) {
    const Prescription lens = published_lens("deeplens_rf50mm_f1.8.toml");
    const LensStack stack(lens, lens.wavelength_nm, HUGE_VAL);
    std::array<dvec3, 12> hits{};
    for (const double y : {-6.0, 2.0, 7.0}) {
        LensRay ray{{1, y, -100}, glm::normalize(dvec3(0.01, -0.02, 1))};
        ASSERT_TRUE(stack.forward(ray, Apertures::ignored, hits).passes());
        for (std::size_t i = 0; i < 12; ++i) {
            const dvec3 p = hits[i] - dvec3(0, 0, stack.vertex_z_mm(i));
            EXPECT_NEAR(p.z, lens.surfaces[i].sag_mm(glm::length(dvec2(p))), 2e-10) << i;
        }
        // The reverse ray follows the same path.
        LensRay back{ray.origin + 50.0 * ray.direction, -ray.direction};
        std::array<dvec3, 12> again{};
        ASSERT_TRUE(stack.backward(back, Apertures::ignored, again).passes());
        for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(glm::distance(again[i], hits[i]), 0, 1e-8) << i;
    }
}

TEST(RealRays, SayWhatStoppedThem) {
    Prescription lens = plate(1.6, 7);
    lens.surfaces[1].curvature_per_mm = -0.05;
    const LensStack stack(lens, d_line_nm, HUGE_VAL);
    LensRay steep{{0, 15, 0}, {0, 0, 1}};  // the sine inside is 15/20, above the critical 1/1.6
    RayEnd end = stack.forward(steep);
    EXPECT_EQ(end.fate, RayFate::reflected);
    EXPECT_EQ(end.surface, 1U);
    LensRay far{{0, 21, 0}, {0, 0, 1}};  // beyond the sphere of 20 mm
    end = stack.forward(far);
    EXPECT_EQ(end.fate, RayFate::misses);
    EXPECT_EQ(end.surface, 1U);
    lens.surfaces[0].clear_radius_mm = 5;
    LensRay wide{{0, 5.1, 0}, {0, 0, 1}};
    end = LensStack(lens, d_line_nm, HUGE_VAL).forward(wide);
    EXPECT_EQ(end.fate, RayFate::vignetted);
    EXPECT_EQ(end.surface, 0U);
    LensRay through{{0, 5.1, 0}, {0, 0, 1}};
    EXPECT_TRUE(LensStack(lens, d_line_nm, HUGE_VAL).forward(through, Apertures::ignored).passes());
}

// Close to the axis, exact rays agree with the first-order values.
TEST(RealRays, TendToTheParaxialOnes) {
    for (const char* name : {"rayoptics_ag_dblgauss.seq", "lentil_0015.toml", "deeplens_rf50mm_f1.8.toml",
                             "dgauss.22deg.50.0mm.dat"}) {
        const Prescription lens = published_lens(name);
        const FirstOrder f = first_order(lens);
        const LensStack stack(lens, lens.wavelength_nm, f.stop_radius_mm);
        const double y = 1e-4 * f.efl_mm;
        LensRay ray{{0, y, 0}, {0, 0, 1}};
        ASSERT_TRUE(stack.forward(ray).passes());
        // Spherical aberration is proportional to y^2: about 1e-8 of the focal length times that of an f/1
        // lens.
        EXPECT_NEAR(-y / (ray.direction.y / ray.direction.z), f.efl_mm, 1e-6 * f.efl_mm) << name;
        EXPECT_NEAR(ray.at_z(stack.last_vertex_z_mm() + f.bfl_mm).y, 0, 1e-6 * y) << name;
    }
}

}  // namespace
}  // namespace postlens::test::real_rays_test
