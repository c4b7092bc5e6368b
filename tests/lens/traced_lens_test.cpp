// Exact rays through lenses: CODE V's listing of real rays, closed forms of simple surfaces, and focusing.
#include "lens/traced/traced_lens.h"

#include <array>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "core/error.h"
#include "core/text.h"
#include "lens/prescription/read_prescription.h"

namespace postlens::test {
namespace {

using glm::dvec2;
using glm::dvec3;

Prescription data(const std::string& name) {
    return read_prescription(std::string(POSTLENS_TEST_DATA) + "/lens/" + name);
}

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
    std::ifstream in(std::string(POSTLENS_TEST_DATA) + "/lens/rayoptics_ag_dblgauss.lis");
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
    const Prescription lens = data("rayoptics_ag_dblgauss.seq");
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
    const Prescription lens = data("rayoptics_ag_dblgauss.seq");
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
    const Prescription lens = data("deeplens_rf50mm_f1.8.toml");
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
        const Prescription lens = data(name);
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

TEST(TracedLensFocus, IsSharpWhereItWasSet) {
    const Prescription lens = data("dgauss.22deg.50.0mm.dat");
    for (const FocusMove move : {FocusMove::film, FocusMove::lens}) {
        for (const double s : {0.5, 2.0, infinite_m}) {
            const TracedLens traced(lens, {.focus_distance_m = s, .move = move});
            // A ray close to the axis from the point in focus hits the film on the axis.
            const double y = 1e-3 * traced.first_order().entrance_pupil_diameter_mm;
            LensRay ray = traced.object_ray(s, dvec2(0), {0, y});
            ASSERT_TRUE(traced.stack().forward(ray).passes());
            EXPECT_NEAR(traced.on_film(ray).y, 0, 1e-6 * y) << s;
            EXPECT_EQ(traced.extension_mm() > 0, move == FocusMove::lens && std::isfinite(s));
        }
    }
    // With FocusMove::lens, film and pinhole keep the distance that they have for a focus at infinity.
    const TracedLens infinite(lens, {.focus_distance_m = INFINITY}),
        near_lens(lens, {.focus_distance_m = 0.5, .move = FocusMove::lens});
    EXPECT_NEAR(near_lens.film_z_mm(), infinite.film_z_mm(), 1e-8);
    EXPECT_THROW(TracedLens(lens, {.focus_distance_m = 0.03}), Error);
    EXPECT_THROW(TracedLens(lens, {.focus_distance_m = 0}), Error);
    EXPECT_THROW(TracedLens(lens, {.f_number = 1.2}), Error);
    EXPECT_THROW(TracedLens(lens, {.f_number = 0}), Error);
}

double rms_mm(const TracedLens& lens, double depth_m) {
    PupilMesh mesh;
    EXPECT_TRUE(lens.impulse(depth_m, dvec2(0), 101, mesh));
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < mesh.passes.size(); ++k) {
        if (mesh.passes[k] == 0) continue;
        sum += glm::dot(mesh.film_mm[k], mesh.film_mm[k]);
        ++count;
    }
    return std::sqrt(sum / count);
}

TEST(TracedLensFocus, TheBestSpotIsSmallerThanTheParaxialOne) {
    // Two simple elements at f/4 have much spherical aberration of one sign.
    const Prescription lens = data("2el.XXdeg.100mm.dat");
    const TracedLens paraxial(lens, {.focus_distance_m = 2, .f_number = 4}),
        best(lens, {.focus_distance_m = 2, .f_number = 4, .criterion = FocusCriterion::rms_spot});
    // Third-order spherical aberration is y^3, and y^3 - d y with defocus; the best d over a disc is 2/3. The
    // mean square decreases from 1/4 to 1/36 of the radius to the sixth, the RMS to a third.
    EXPECT_LT(rms_mm(best, 2), 0.4 * rms_mm(paraxial, 2));
    // The spot is larger for distances on both sides.
    EXPECT_LT(rms_mm(best, 2), rms_mm(best, 1.98));
    EXPECT_LT(rms_mm(best, 2), rms_mm(best, 2.02));
}

TEST(TracedLensFilm, RaysGoBothWays) {
    const Prescription lens = data("dgauss.22deg.50.0mm.dat");
    const TracedLens traced(lens, {.focus_distance_m = 1, .f_number = 4});
    int passed = 0;
    for (int i = 0; i < 400; ++i) {
        const int column = i % 20, row = i / 20;
        const dvec2 film(column - 10, row - 10);
        SceneRay out;
        if (!traced.scene_ray(film, {std::fmod(i * 0.618, 1.0), std::fmod(i * 0.414, 1.0)}, out)) continue;
        ++passed;
        EXPECT_LT(out.direction.z, 0);
        EXPECT_NEAR(glm::length(out.direction), 1, 1e-14);
        // The image on the film is upside down.
        if (glm::length(film) > 1) {
            EXPECT_LT(glm::dot(film, dvec2(out.direction)), 0);
        }
        LensRay back{out.origin_mm + dvec3(0, 0, traced.pinhole_from_vertex_mm()), -out.direction};
        ASSERT_TRUE(traced.stack().forward(back, Apertures::ignored).passes());
        EXPECT_NEAR(glm::distance(traced.on_film(back), film), 0, 1e-9);
    }
    EXPECT_GT(passed, 200);
    SceneRay out;
    EXPECT_FALSE(traced.scene_ray({30, 0}, {0.5, 0.5}, out));
    EXPECT_TRUE(traced.scene_ray({0, 0}, {0.5, 0.5}, out));
}

// Irradiance at a film point for a uniform scene, relative to that at the centre.
double irradiance(const TracedLens& lens, dvec2 film, int nodes = 200) {
    double sum = 0;
    for (int j = 0; j < nodes; ++j) {
        for (int i = 0; i < nodes; ++i) {
            SceneRay ray;
            if (lens.scene_ray(film, {(i + 0.5) / nodes, (j + 0.5) / nodes}, ray)) sum += ray.weight;
        }
    }
    return sum / (nodes * nodes);
}

TEST(TracedLensFilm, TheWeightsAreTheLightOfAUniformScene) {
    const Prescription lens = data("dgauss.22deg.50.0mm.dat");
    for (const double n : {2.8, 8.0}) {
        const TracedLens traced(lens, {.focus_distance_m = INFINITY, .f_number = n});
        // A lens that meets the sine condition has E0 = pi / (4 n^2) at infinity. Aberrations of this lens
        // displace the edge of the pupil by about 1 %, and the steps of the sum have an error of 1 / 256.
        EXPECT_NEAR(traced.axial_irradiance_sr(), std::numbers::pi / (4 * n * n),
                    0.03 * traced.axial_irradiance_sr());
        // The steps differ from those of the normalisation: 1 / 200 at the edge of the disc.
        EXPECT_NEAR(irradiance(traced, dvec2(0)), 1, 0.01);
    }
    // At a small aperture without vignetting, light falls off with cos^4 of the angle at the exit pupil,
    // equally in all directions.
    const TracedLens small(lens, {.focus_distance_m = INFINITY, .f_number = 16});
    const double to_pupil = small.film_distance_mm() - small.first_order().exit_pupil_z_mm;
    for (const double r : {3.0, 6.0}) {
        const double expected = std::pow(1 + r * r / (to_pupil * to_pupil), -2.0);
        // The distortion of the pupil, (r/f)^2, is a few per cent.
        EXPECT_NEAR(irradiance(small, {r, 0}), expected, 0.03) << r;
        EXPECT_NEAR(irradiance(small, {0, -r}), irradiance(small, {r, 0}), 0.01);
        EXPECT_NEAR(irradiance(small, {r * 0.6, r * 0.8}), irradiance(small, {r, 0}), 0.01);
    }
    // Wide open, the rims vignette.
    const TracedLens open(lens, {.focus_distance_m = INFINITY});
    EXPECT_LT(irradiance(open, {0, 10}), 0.8 * std::pow(1 + 100 / (to_pupil * to_pupil), -2.0));
}

// The rectangles that scene_ray samples contain all transmitted rays: the light equals that from the whole
// rear surface, for film points at and between the zones for which rectangles are stored.
TEST(TracedLensFilm, NoLightIsOutsideOfTheRectangles) {
    const Prescription lens = data("dgauss.22deg.50.0mm.dat");
    for (const double n : {2.04, 5.6}) {
        const TracedLens traced(lens, {.focus_distance_m = 3, .f_number = n, .film_radius_mm = 16});
        const double z = traced.stack().last_vertex_z_mm(), to_film = traced.film_distance_mm();
        for (const double r : {0.0, 3.3, 7.99, 8.0, 12.6, 15.9}) {
            const dvec2 film(0.6 * r, 0.8 * r);
            constexpr int nodes = 300;
            const double clear = 10.2, step = 2 * clear / nodes;
            double sum = 0;
            for (int k = 0; k < nodes * nodes; ++k) {
                const int i = k % nodes, j = k / nodes;
                const dvec2 p((i + 0.5) * step - clear, (j + 0.5) * step - clear);
                const dvec3 from(film, z + to_film);
                LensRay ray{from, glm::normalize(dvec3(p, z) - from)};
                const double cosine = -ray.direction.z;
                if (traced.stack().backward(ray).passes()) sum += std::pow(cosine, 4);
            }
            const double expected = sum * step * step / (to_film * to_film) / traced.axial_irradiance_sr();
            // Two grids of about 150 (f/2) and 50 (f/5.6) cells across differ at their edges by less than
            // this.
            EXPECT_NEAR(irradiance(traced, film), expected, n < 3 ? 0.006 : 0.012) << n << " " << r;
        }
    }
}

TEST(TracedLensImpulse, IsADiscOfTheCircleOfConfusionsSize) {
    const Prescription lens = data("rayoptics_ag_dblgauss.seq");
    const TracedLens traced(lens, {.focus_distance_m = 2, .f_number = 16});
    PupilMesh mesh;
    for (const double depth : {1.0, 4.0, infinite_m}) {
        ASSERT_TRUE(traced.impulse(depth, dvec2(0), 201, mesh));
        EXPECT_TRUE(mesh.has_chief);
        EXPECT_EQ(mesh.chief_film_mm, dvec2(0));
        double widest = 0;
        for (std::size_t k = 0; k < mesh.passes.size(); ++k)
            widest = std::max(widest, glm::length(mesh.film_mm[k]));
        // The paraxial radius is q (1/s - 1/z') times the distance of the film from the pupil's conjugate. It
        // is computed here by the image's distance and the exit pupil.
        const FirstOrder& f = traced.first_order();
        const double image =
            paraxial_image_z_mm(lens, lens.wavelength_nm, f.entrance_pupil_z_mm - depth * 1000);
        const double radius = 0.5 * f.exit_pupil_diameter_mm * f.f_number / 16 *
                              std::abs(traced.film_distance_mm() - image) / (image - f.exit_pupil_z_mm);
        // Tolerance: a step of the grid at the edge, 0.5 %, and aberrations at f/16, 1 %.
        EXPECT_NEAR(widest, radius, 0.015 * radius) << depth;
        // The passing area is that of the pupil's disc.
        const double area = std::numbers::pi / 4 * std::pow(f.efl_mm / 16, 2);
        EXPECT_NEAR(mesh.passing_area_mm2, area, 0.015 * area);
    }
}

TEST(TracedLensImpulse, TurnsWithTheField) {
    const Prescription lens = data("dgauss.22deg.50.0mm.dat");
    const TracedLens traced(lens, {.focus_distance_m = 2});
    PupilMesh up, aslant;
    ASSERT_TRUE(traced.impulse(3, {0, 0.15}, 301, up));
    ASSERT_TRUE(traced.impulse(3, {0.15 * 0.6, 0.15 * 0.8}, 301, aslant));
    EXPECT_NEAR(glm::length(up.chief_film_mm), glm::length(aslant.chief_film_mm), 1e-9);
    EXPECT_LT(up.chief_film_mm.y, 0);
    EXPECT_NEAR(up.passing_area_mm2, aslant.passing_area_mm2, 0.01 * up.passing_area_mm2);
    // Off the axis the rims vignette the pupil (a cat's eye).
    PupilMesh axis;
    ASSERT_TRUE(traced.impulse(3, dvec2(0), 301, axis));
    EXPECT_LT(up.passing_area_mm2, 0.9 * axis.passing_area_mm2);
    EXPECT_FALSE(traced.impulse(3, {0, 3}, 11, up));
}

TEST(TracedLensImpulse, ThroughTheFisheyeAndTheAspheres) {
    const TracedLens fisheye(data("lentil_0015.toml"), {.focus_distance_m = INFINITY, .film_radius_mm = 1.4});
    PupilMesh mesh;
    ASSERT_TRUE(fisheye.impulse(INFINITY, {0, tangent(60)}, 65, mesh));
    // The projection is equidistant: the height is f times the angle, well below f times its tangent.
    EXPECT_NEAR(-mesh.chief_film_mm.y, std::numbers::pi / 3, 0.15);
    // The chief ray is found even where the pupil has moved by more than its own size.
    const auto aim = fisheye.aim_at_stop(INFINITY, {0, tangent(75)});
    ASSERT_TRUE(aim.has_value());
    EXPECT_GT(glm::length(*aim), fisheye.first_order().entrance_pupil_diameter_mm);
    EXPECT_NEAR(glm::length(fisheye.stack().at_stop(fisheye.object_ray(INFINITY, {0, tangent(75)}, *aim))), 0,
                1e-9);
    const TracedLens aspheric(data("deeplens_rf50mm_f1.8.toml"), {.focus_distance_m = INFINITY});
    ASSERT_TRUE(aspheric.impulse(INFINITY, {0, 0.2}, 65, mesh));
    EXPECT_NEAR(-mesh.chief_film_mm.y, 0.2 * aspheric.first_order().efl_mm, 0.3);
}

}  // namespace
}  // namespace postlens::test
