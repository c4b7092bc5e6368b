// A real lens with distortion removed: positions and light of rays, compared with slow sums over rays.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "lens/prescription/read_prescription.h"
#include "lens/traced/fan_table.h"

namespace postlens::test::lens_view_test {
namespace {

using glm::dvec2;
using glm::dvec3;

const std::string lenses = std::string(POSTLENS_TEST_DATA) + "/lens/";
constexpr double half_diagonal_px = 400, gain_px = 1000;

LensView view_of(const std::string& name, double focus_m, Framing framing = Framing::keep,
                 std::optional<double> f_number = std::nullopt) {
    return LensView(read_prescription(lenses + name), {.focus_distance_m = focus_m,
                                                       .f_number = f_number,
                                                       .framing = framing,
                                                       .film = {.distance_mm = 50, .pixel_pitch_mm = 0.05},
                                                       .half_diagonal_px = half_diagonal_px});
}

// In focus, the rays of a pixel go through the point of the plane in focus that the pinhole sees, except for
// aberrations. At f/4 and 11 degrees these have an RMS below a tenth of the blur for a defocus equal to the
// focus itself (0.7). Rays with wrong orientation or scale would have errors as large as that blur.
TEST(LensView, RaysMeetWhereThePinholeLooks) {
    for (const char* name : {"rayoptics_ag_dblgauss.seq", "lentil_0004.toml", "dgauss.22deg.50.0mm.dat"}) {
        const double focus_m = 2;
        const LensView view = view_of(name, focus_m, Framing::keep, 4);
        for (const dvec2& tangent : {dvec2(0), dvec2(0.1, 0), dvec2(-0.1, 0.15), dvec2(0.02, -0.19)}) {
            double sum = 0, light = 0;
            constexpr int steps = 40;
            for (int k = 0; k < steps * steps; ++k) {
                ViewRay ray;
                if (!view.ray(tangent, dvec2(k % steps + 0.5, k / steps + 0.5) / double{steps}, ray))
                    continue;
                const dvec2 off = ray.lens_m / focus_m + ray.tangent - tangent;
                sum += ray.weight * glm::dot(off, off);
                light += ray.weight;
            }
            ASSERT_GT(light, 0) << name;
            EXPECT_LT(std::sqrt(sum / light), 0.1 * view.geometry().aperture_radius_m / focus_m)
                << name << ", " << tangent.x << ", " << tangent.y;
        }
    }
}

TEST(LensView, StraightenedIsTheWayBack) {
    const LensView view = view_of("lentil_0004.toml", 1);
    for (double t = 0; t < 0.41; t += 0.0137) {
        const double r = view.film_radius_mm(t);
        const dvec2 back = view.straightened(r * dvec2(0.6, -0.8));
        EXPECT_NEAR(back.x, -0.6 * t, 1e-12);
        EXPECT_NEAR(back.y, 0.8 * t, 1e-12);
        EXPECT_NEAR(view.film_mm_per_tangent(t),
                    (view.film_radius_mm(t + 1e-5) - view.film_radius_mm(t - 1e-5)) / 2e-5,
                    1e-3 * view.film_scale_mm())
            << t;
    }
}

TEST(LensView, FramingsHaveTheFilmWhereTheySay) {
    const std::string name = "rayoptics_ag_dblgauss.seq";
    EXPECT_DOUBLE_EQ(view_of(name, 2).geometry().gain_px, gain_px);
    const LensView at_focal_length = view_of(name, 2, Framing::lens);
    EXPECT_NEAR(at_focal_length.geometry().gain_px, 100.0038 / 0.05, 0.01);
    EXPECT_NEAR(at_focal_length.geometry().zoom, 2, 1e-4);
    // With the focus at infinity the film distance is the focal length; with a nearer focus it is F / (1 - F
    // / s) from the principal planes, which lie within 0.1 m of the pinhole. The pupils have a ratio of 50
    // : 57.3.
    EXPECT_NEAR(view_of(name, HUGE_VAL, Framing::breathing).geometry().gain_px, 100.0038 / 0.05, 0.02);
    EXPECT_NEAR(view_of(name, 2, Framing::breathing).geometry().gain_px, 100.0038 / (1 - 0.1 / 2) / 0.05, 15);
}

/// Counts the rays of one object point per pixel.
ResponseGrid counted(const LensView& view, double w, double tangent, const dvec2& axis) {
    const PixelWindow window{-60, 60, -60, 60};
    ResponseGrid out(window.x_begin, window.y_begin, 120, 120);
    std::mt19937_64 random(3);
    const double extent_m = 1.6 * view.geometry().aperture_radius_m;
    std::uniform_real_distribution<double> even(-extent_m, extent_m);
    const TracedLens& lens = view.lens();
    const dvec2 field = tangent * axis;
    double total = 0;
    for (int i = 0; i < 500'000; ++i) {
        const dvec2 q(even(random), even(random));  // in the axes of the camera
        const dvec2 t = dvec2(field.x, -field.y);
        LensRay ray{dvec3(1e3 * q, lens.pinhole_from_vertex_mm()), glm::normalize(dvec3(w * q - t, 1))};
        const double cosine = ray.direction.z;
        if (!lens.stack().forward(ray).passes()) continue;
        const dvec2 moved = view.straightened(lens.on_film(ray)) - t;
        const double light = std::pow(cosine, 4);
        total += light;
        const int x = static_cast<int>(std::floor(gain_px * moved.x)) - window.x_begin,
                  y = static_cast<int>(std::floor(-gain_px * moved.y)) - window.y_begin;
        if (x >= 0 && x < out.width && y >= 0 && y < out.height) out.at(x, y) += light;
    }
    for (double& s : out.share) s /= total;
    return out;
}

// Half the sum of absolute differences is the share of light in wrong pixels. The noise of counting N rays in
// m pixels of equal light is sqrt(2 m / (pi N)) / 2, at most 0.03 (1000 px). The table may add 0.02, which is
// an error of 0.01 of the radius at the edge, or 0.1 px for responses of a few pixels: a ring of 0.2 /
// radius.
TEST(FanTable, HasTheResponseOfRays) {
    const double focus_m = 2;
    bool far = false;
    for (const char* name : {"lentil_0009.toml", "lentil_0004.toml", "rayoptics_ag_dblgauss.seq"}) {
        const LensView view = view_of(name, focus_m, Framing::keep, 2.8);
        const FanTable table(view, 1.6, half_diagonal_px / gain_px);
        for (const double w : {0.0, 0.45, 1.3}) {
            // Near the axis and far from it in turn: half of all combinations.
            far = !far;
            for (const dvec2& place : {far ? dvec2(0.12, 0.16) : dvec2(0, 0.05)}) {
                const double tangent = glm::length(place);
                const dvec2 axis = place / tangent;
                const ResponseGrid truth = counted(view, w, tangent, axis);
                const ResponseGrid got = fan_response(table.fan(w, tangent),
                                                      {.gain_px = gain_px, .axis = axis}, {-60, 60, -60, 60});
                double difference = 0, lit = 0;
                for (int y = -60; y < 60; ++y) {
                    for (int x = -60; x < 60; ++x) {
                        const int i = x - got.x_begin, j = y - got.y_begin;
                        const bool inside = i >= 0 && i < got.width && j >= 0 && j < got.height;
                        const double expected = truth.at(x + 60, y + 60);
                        difference += std::abs((inside ? got.at(i, j) : 0) - expected);
                        if (expected > 0) ++lit;
                    }
                }
                const double noise = std::sqrt(2 * lit / (3.14 * 150'000)) / 2;
                const double radius_px = std::sqrt(lit / 3.14);
                EXPECT_LT(difference / 2, noise + std::max(0.02, 0.2 / radius_px))
                    << name << ", " << w << " / m, " << place.x << ", " << place.y << ", " << lit << " px";
            }
        }
    }
}

// Compares the light of a pixel by rays from the pixel with that of the table by rays from an object point.
TEST(FanTable, LosesTheLightThatRaysLose) {
    bool far = false;
    for (const char* name : {"lentil_0009.toml", "lentil_0004.toml", "rayoptics_ag_dblgauss.seq"}) {
        const double focus_m = 2;
        const LensView view = view_of(name, focus_m);
        const FanTable table(view, 1, half_diagonal_px / gain_px);
        // Each lens has half of the fields, and each field one lens or two.
        far = !far;
        for (double tangent = far ? 0.05 : 0; tangent <= 0.41; tangent += 0.1) {
            double light = 0;
            constexpr int steps = 300;
            for (int k = 0; k < steps * steps; ++k) {
                ViewRay ray;
                if (view.ray({0.6 * tangent, -0.8 * tangent},
                             dvec2(k % steps + 0.5, k / steps + 0.5) / double{steps}, ray))
                    light += ray.weight;
            }
            // Errors: an inscribed polygon of 96 sides lacks 7e-4, a grid of 300^2 nodes has 300^-1.5 = 2e-4,
            // and interpolation between 25 fields has less than 0.005 where vignetting begins.
            EXPECT_NEAR(table.light(tangent), light / (steps * steps), 0.006) << name << ", " << tangent;
        }
    }
}

// The chords by which fan_response approximates the pupil's edge have a small error for any size.
TEST(PupilFan, OfAThinMapIsTheDisc) {
    PupilFan fan;
    for (std::size_t ring = 0; ring <= PupilFan::rings; ++ring) {
        for (std::size_t spoke = 0; spoke <= PupilFan::spokes; ++spoke) {
            const double angle = M_PI * static_cast<double>(spoke) / PupilFan::spokes,
                         r = static_cast<double>(ring) / PupilFan::rings;
            const dvec2 q = r * dvec2(std::sin(angle), std::cos(angle));
            fan.at(ring, spoke) = {q, q, 1};
        }
    }
    for (const double radius_px : {0.7, 3.0, 10.0, 50.0}) {
        const int window = 64;
        const ResponseGrid got = fan_response(fan, {.gain_px = radius_px, .centre_px = {0.3, 0.6}},
                                              {-window, window, -window, window});
        const double density = 1 / (M_PI * radius_px * radius_px);
        double sum = 0;
        for (int j = 0; j < got.height; ++j) {
            for (int i = 0; i < got.width; ++i) {
                sum += got.at(i, j);
                const double x = got.x_begin + i + 0.5 - 0.3, y = got.y_begin + j + 0.5 - 0.6;
                const double r = std::hypot(x, y);
                if (r < radius_px - 1) {
                    EXPECT_NEAR(got.at(i, j) / density, 1, 0.05) << radius_px;
                } else if (r > radius_px + 1) {
                    EXPECT_NEAR(got.at(i, j) / density, 0, 1e-9) << radius_px;
                }
            }
        }
        EXPECT_NEAR(sum, 1, 1e-9);
    }
}

}  // namespace
}  // namespace postlens::test::lens_view_test
