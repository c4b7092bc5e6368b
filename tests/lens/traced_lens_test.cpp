// Traced lenses: focusing, rays between film and scene, and impulse responses.
#include "lens/traced/traced_lens.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <string>

#include "core/error.h"
#include "lens/prescription/prescription.h"
#include "tests/lens/lens_files.h"

namespace postlens::test::traced_lens_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double infinite_m = std::numeric_limits<double>::infinity();

double tangent(double deg) {
    return std::tan(deg * std::numbers::pi / 180);
}

TEST(TracedLensFocus, IsSharpWhereItWasSet) {
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
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
    // No object within four focal lengths of its image is sharp. The error names the distance that was asked
    // for, and the least one, measured from the pupil.
    const FirstOrder& f = infinite.first_order();
    const double least_m = (f.entrance_pupil_z_mm - f.ffl_mm + 2 * f.efl_mm) * 1e-3;
    EXPECT_NO_THROW(TracedLens(lens, {.focus_distance_m = 1.01 * least_m, .move = FocusMove::lens}));
    for (const double s : {0.1 * least_m, 0.6 * least_m, 0.999 * least_m}) {
        try {
            (void)TracedLens(lens, {.focus_distance_m = s, .move = FocusMove::lens});
            ADD_FAILURE() << s;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(
                          fmt::format("(got {} m; expected more than about {:.4g} m", s, least_m)),
                      std::string::npos)
                << e.what();
        }
    }
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
    const Prescription lens = published_lens("2el.XXdeg.100mm.dat");
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
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
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
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
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
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
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
    const Prescription lens = published_lens("rayoptics_ag_dblgauss.seq");
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
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
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
    const TracedLens fisheye(published_lens("lentil_0015.toml"),
                             {.focus_distance_m = INFINITY, .film_radius_mm = 1.4});
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
    const TracedLens aspheric(published_lens("deeplens_rf50mm_f1.8.toml"), {.focus_distance_m = INFINITY});
    ASSERT_TRUE(aspheric.impulse(INFINITY, {0, 0.2}, 65, mesh));
    EXPECT_NEAR(-mesh.chief_film_mm.y, 0.2 * aspheric.first_order().efl_mm, 0.3);
}

}  // namespace
}  // namespace postlens::test::traced_lens_test
