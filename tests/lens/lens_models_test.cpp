// Models of a traced lens: each agrees with the next more expensive one where its assumptions hold.
#include "lens/traced/lens_models.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "core/error.h"
#include "lens/thin_lens.h"
#include "lens/traced/lens_section.h"
#include "lens/traced/mesh_response.h"
#include "tests/lens/lens_files.h"

namespace postlens::test::lens_models_test {
namespace {

using glm::dvec2;
constexpr double infinite_m = std::numeric_limits<double>::infinity();

TEST(LensModels, TheThinLensHasItsCircleOfConfusion) {
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
    const TracedLens traced(lens, {.focus_distance_m = 2, .f_number = 4});
    const LensModels models(lens, traced);
    const ThinLens thin{traced.first_order().efl_mm, 4};
    for (const double depth : {0.7, 2.0, 5.0, infinite_m}) {
        const double radius = 0.5 * thin.aperture_diameter_mm();
        const ModelRay ray = models.ray(LensModelKind::thin, depth, 0.1, {radius * (1 - 1e-9), 0});
        EXPECT_TRUE(ray.passes);
        // Behind the focus the rays have crossed.
        EXPECT_NEAR(-2 * ray.film_mm.x, coc_diameter_mm(thin, 2, depth), 1e-6);
        EXPECT_FALSE(models.ray(LensModelKind::thin, depth, 0.1, {radius * 1.001, 0}).passes);
    }
}

TEST(LensModels, TheThickLensIsExactCloseToTheAxis) {
    for (const char* name : {"dgauss.22deg.50.0mm.dat", "telephoto.250mm.dat", "lentil_0004.toml"}) {
        const Prescription lens = published_lens(name);
        const TracedLens traced(lens, {.focus_distance_m = 5});
        const LensModels models(lens, traced);
        for (const double depth : {2.0, 8.0, infinite_m}) {
            const dvec2 pupil(1e-3 * traced.first_order().entrance_pupil_diameter_mm, 0);
            const ModelRay thick = models.ray(LensModelKind::thick, depth, 0, pupil);
            const ModelRay exact = models.ray(LensModelKind::traced, depth, 0, pupil);
            // Third-order aberration at 1/500 of the pupil's radius is 1e-8 of that at the edge, at most 1
            // mm.
            EXPECT_NEAR(thick.film_mm.x, exact.film_mm.x, 1e-6 * std::abs(thick.film_mm.x) + 1e-8)
                << name << depth;
        }
        EXPECT_EQ(models.error_mm(LensModelKind::traced, 2, 0), 0);
    }
}

TEST(LensModels, ErrorsFallFromModelToModel) {
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
    const TracedLens traced(lens, {.focus_distance_m = 2, .f_number = 2.8});
    const LensModelRange range = lens_model_range(traced, 1, infinite_m, 12, 5);
    ASSERT_EQ(range.depths_m.size(), 5U);
    EXPECT_EQ(range.depths_m.front(), 1);
    EXPECT_EQ(range.depths_m.back(), infinite_m);
    EXPECT_EQ(range.tangents.front(), 0);
    // The chief ray of the last tangent hits the film at the requested height.
    LensRay chief = traced.object_ray(infinite_m, {0, range.tangents.back()},
                                      traced.aim_at_stop(infinite_m, {0, range.tangents.back()}).value());
    ASSERT_TRUE(traced.stack().forward(chief, Apertures::ignored).passes());
    EXPECT_NEAR(std::abs(traced.on_film(chief).y), 12, 1e-6);
    LensModels models(lens, traced);
    models.set_polynomial(fit_polynomial_lens(lens, traced, range));
    const double thin = models.error_mm(LensModelKind::thin, range),
                 thick = models.error_mm(LensModelKind::thick, range),
                 polynomial = models.error_mm(LensModelKind::polynomial, range);
    // Pupil and principal planes of this lens are close together, so the first two models lack only
    // aberrations and vignetting, and differ by less than 1 %.
    EXPECT_NEAR(thick, thin, 0.01 * thin);
    // Three circles cannot follow the edge of a strongly vignetted pupil. Without vignetting the error is
    // small.
    EXPECT_LT(polynomial, 0.55 * thick);
    EXPECT_LT(models.error_mm(LensModelKind::polynomial, 2, 0),
              0.1 * models.error_mm(LensModelKind::thick, 2, 0));
    EXPECT_GT(polynomial, 0);
    // Between the samples of the fit the polynomial is not much less accurate.
    const LensModelRange between{{1.2, 3.0}, {0.6 * range.tangents.back()}};
    EXPECT_LT(models.error_mm(LensModelKind::polynomial, between), 1.2 * polynomial);
}

TEST(LensModels, ATelephotoLensIsNoThinLens) {
    // Its front principal plane is 98 mm in front of its pupil, from which distances are measured. The object
    // in focus is closer by this than for a thin lens, and all blur is larger by (s - F) / (s_H - F).
    const Prescription lens = published_lens("telephoto.250mm.dat");
    const TracedLens traced(lens, {.focus_distance_m = 3, .f_number = 16});
    const LensModels models(lens, traced);
    const FirstOrder& f = traced.first_order();
    const double to_principal = 3000 + f.front_principal_z_mm - f.entrance_pupil_z_mm;
    const double ratio = (3000 - f.efl_mm) / (to_principal - f.efl_mm);
    EXPECT_GT(ratio, 1.03);
    const dvec2 pupil(0.01, 0);
    for (const double depth : {2.0, 5.0}) {
        const double thin = models.ray(LensModelKind::thin, depth, 0, pupil).film_mm.x;
        EXPECT_NEAR(models.ray(LensModelKind::thick, depth, 0, pupil).film_mm.x, ratio * thin, 1e-9);
        EXPECT_NEAR(models.ray(LensModelKind::traced, depth, 0, pupil).film_mm.x, ratio * thin,
                    1e-6 * std::abs(thin));
    }
}

TEST(LensModels, StoppedDownAndOnAxisTheThickLensIsEnough) {
    const Prescription lens = published_lens("rayoptics_ag_dblgauss.seq");
    const TracedLens traced(lens, {.focus_distance_m = 3, .f_number = 22});
    const LensModelRange range = lens_model_range(traced, 1, 10, 0, 5);
    EXPECT_EQ(range.tangents.size(), 1U);
    const LensModels models(lens, traced);
    // Aberrations at f/22 are below 1 um. The rest is the edge of the pupil, sampled in steps of 1/20.
    EXPECT_LT(models.error_mm(LensModelKind::thick, range),
              0.1 * models.error_mm(LensModelKind::thin, range) + 0.02);
}

TEST(LensModels, RangesAreChecked) {
    const TracedLens traced(published_lens("dgauss.22deg.50.0mm.dat"), {.focus_distance_m = 2});
    EXPECT_THROW((void)lens_model_range(traced, 0, 1, 1, 3), Error);
    EXPECT_THROW((void)lens_model_range(traced, 2, 1, 1, 3), Error);
    EXPECT_THROW((void)lens_model_range(traced, 1, 2, -1, 3), Error);
    EXPECT_THROW((void)lens_model_range(traced, 1, 2, 500, 3), Error);
}

// In a double Gauss, chief rays of large field angles land nearer to the centre again. The largest distance
// that the error states is therefore not at the largest angle.
TEST(LensModels, AFieldThatIsTooLargeNamesTheLargest) {
    const TracedLens traced(read_prescription(POSTLENS_SAMPLES "/lenses/double_gauss.toml"));
    try {
        (void)lens_model_range(traced, 1, 2, 500, 3);
        FAIL() << "500 mm is accepted";
    } catch (const Error& error) {
        const std::string text = error.what(), before = "at most about ";
        const double largest_mm = std::stod(text.substr(text.find(before) + before.size()));
        // The text has four digits.
        EXPECT_NO_THROW((void)lens_model_range(traced, 1, 2, largest_mm * (1 - 5e-4), 3)) << text;
        EXPECT_THROW((void)lens_model_range(traced, 1, 2, largest_mm * 1.01, 3), Error) << text;
    }
}

TEST(MeshResponse, HoldsAllLightAndItsPlace) {
    const TracedLens traced(published_lens("dgauss.22deg.50.0mm.dat"),
                            {.focus_distance_m = 1, .f_number = 4});
    PupilMesh mesh;
    ASSERT_TRUE(traced.impulse(3, {0.1, 0.05}, 129, mesh));
    const ResponseGrid grid = mesh_response(mesh, 0.01);
    double sum = 0, x = 0, y = 0;
    for (int j = 0; j < grid.height; ++j) {
        for (int i = 0; i < grid.width; ++i) {
            EXPECT_GE(grid.at(i, j), 0);
            sum += grid.at(i, j);
            x += grid.at(i, j) * (grid.x_begin + i);
            y += grid.at(i, j) * (grid.y_begin + j);
        }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    dvec2 mean(0);
    double passing = 0;
    for (std::size_t k = 0; k < mesh.passes.size(); ++k) {
        mean += static_cast<double>(mesh.passes[k]) * mesh.film_mm[k];
        passing += mesh.passes[k];
    }
    mean /= passing;
    // Compares centroids on the upright raster. Cells at the pupil's edge are left out: a ring of 1/128 of
    // the response of about 35 px, nearly equal on all sides.
    EXPECT_NEAR(x, -mean.x / 0.01, 0.15);
    EXPECT_NEAR(y, mean.y / 0.01, 0.15);
}

TEST(LensSection, DrawsEveryElementAndTheRays) {
    const Prescription lens = published_lens("dgauss.22deg.50.0mm.dat");
    const TracedLens traced(lens, {.focus_distance_m = infinite_m});
    const LensSection section = lens_section(lens, traced, infinite_m, {0, 0.2}, 7);
    EXPECT_EQ(section.glass.size(), 6U);
    EXPECT_EQ(section.stop.size(), 2U);
    EXPECT_TRUE(section.planes.empty());
    EXPECT_GE(section.rays.size(), 12U);
    for (const auto& ray : section.rays) {
        EXPECT_EQ(ray.points.size(), lens.surfaces.size() + 2);
        EXPECT_NEAR(ray.points.back().x, section.film_z_mm, 1e-12);
        // A ray from a field above the axis hits the film below it.
        if (ray.field == 1) {
            EXPECT_LT(ray.points.back().y, -5);
        }
    }
}

}  // namespace
}  // namespace postlens::test::lens_models_test
