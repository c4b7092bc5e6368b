// Images whose pixels have closed forms: defocused edges and lights, moving bars.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "tests/support/scene_builder.h"
#include "tests/tracer/repeated_renders.h"

namespace postlens::test::closed_form_test {
namespace {

using glm::dvec3;

constexpr int width = 64, height = 4;
// 36 mm of film at a distance of 50 mm from the lens. A pixel is z / gain_px m wide at depth z.
constexpr double film_width_mm = 36, film_distance_mm = 50,
                 gain_px = film_distance_mm / (film_width_mm / width);

// Images and rays are stored as floats: 2^-24 of the raster's half width is 2e-6 px.
constexpr double rounding = 4e-6;

SceneBuilder strip() {
    SceneBuilder b;
    Camera& c = b.scene.cameras[0];
    c.width = width;
    c.height = height;
    c.film_width_mm = film_width_mm;
    c.focal_length_mm = film_distance_mm;
    return b;
}

// World x, m, of a raster position x at a depth.
double world_x(double x_px, double depth_m) {
    return (x_px - 0.5 * width) / gain_px * depth_m;
}

// A rectangle at a depth that spans the whole height of the image and columns x0 to x1, px.
Rectangle upright(double x0_px, double x1_px, double depth_m) {
    const double x0 = world_x(x0_px, depth_m), half = 50 * depth_m;
    return {{x0, -half, -depth_m}, {world_x(x1_px, depth_m) - x0, 0, 0}, {0, 2 * half, 0}};
}

constexpr double far_px = 1e5;

// The fraction of a disc of radius r that lies right of an edge at 0, if the disc's centre is at x.
double disc_edge(double x, double r) {
    const double t = std::clamp(x / r, -1.0, 1.0);
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
}

std::vector<double> edge_columns(double edge_px, double coc_diameter_px, double behind, double front) {
    std::vector<double> out;
    for (int x = 0; x < width; ++x) {
        const double share =
            mean_over(x, x + 1, [&](double at) { return disc_edge(at - edge_px, 0.5 * coc_diameter_px); });
        out.push_back(behind + (front - behind) * share);
    }
    return out;
}

struct Lens {
    double f_number, focus_m;
    static constexpr double focal_length_mm = 200;  // gives a wide lens; the field of view is that of 50 mm
    [[nodiscard]] double coc_px(double depth_m) const {
        return gain_px * focal_length_mm * 1e-3 / f_number * std::abs(1 / focus_m - 1 / depth_m);
    }
};

RenderSettings through(const Lens& lens, int spp, SamplerKind sampler = SamplerKind::sobol) {
    RenderSettings s;
    s.focal_length_mm = Lens::focal_length_mm;
    s.f_number = lens.f_number;
    s.focus_m = lens.focus_m;
    s.spp = spp;
    s.sampler = sampler;
    return s;
}

// An emitting half-plane right of edge_px, with nothing behind it.
SceneBuilder half_plane(double edge_px, double depth_m) {
    SceneBuilder b = strip();
    b.add(upright(edge_px, far_px, depth_m), glowing(dvec3(1)));
    return b;
}

TEST(OutOfFocus, AStepEdgeIsTheIntegralOfADisc) {
    struct Case {
        double edge_px, depth_m;
        Lens lens;
    };
    // Half-planes behind and before the focus, a focus at infinity, and a CoC smaller than a pixel.
    const std::array<Case, 4> cases{
        {{30.3, 4, {1, 1}}, {33.8, 0.7, {1, 1}}, {25.5, 3, {0.5, 1e308}}, {31.1, 2, {8, 3}}}};
    for (const Case& c : cases) {
        const double coc = c.lens.coc_px(c.depth_m);
        const auto got = repeated(half_plane(c.edge_px, c.depth_m).scene, through(c.lens, 64), column_means);
        expect_figures(got, edge_columns(c.edge_px, coc, 0, 1), rounding, "edge");
        EXPECT_LT(coc, 2 * std::min(c.edge_px, width - c.edge_px)) << "the edge should end within the raster";
    }
    EXPECT_GT(cases[0].lens.coc_px(cases[0].depth_m), 13);
    EXPECT_LT(cases[3].lens.coc_px(cases[3].depth_m), 1);
}

// The background is uniform, so its own defocus has no effect on the image.
TEST(OutOfFocus, AnEvenBackgroundLeavesTheEdgeAsItIs) {
    const Lens lens{1, 1};
    constexpr double edge_px = 29.4, depth_m = 1.6;
    const auto expected = edge_columns(edge_px, lens.coc_px(depth_m), 0.25, 1);
    for (const double behind_m : {1.7, 5.0, 200.0}) {
        SceneBuilder b = half_plane(edge_px, depth_m);
        b.add(upright(-far_px, far_px, behind_m), glowing(dvec3(0.25)));
        expect_figures(repeated(b.scene, through(lens, 64), column_means), expected, rounding,
                       "before a wall");
    }
    // The same image must result with the focus on the wall behind, and with the background colour instead of
    // a wall.
    SceneBuilder b = half_plane(edge_px, depth_m);
    b.scene.background = dvec3(0.25);
    expect_figures(repeated(b.scene, through(lens, 64), column_means), expected, rounding, "before nothing");
    const Lens on_wall{0.9, 5};
    b.add(upright(-far_px, far_px, 5), glowing(dvec3(0.25)));
    expect_figures(repeated(b.scene, through(on_wall, 64), column_means),
                   edge_columns(edge_px, on_wall.coc_px(depth_m), 0.25, 1), rounding, "focus on the wall");
}

// `grid` is left out: only the pairing of its sets is random, so its mean may be biased (see the next test).
TEST(OutOfFocus, EverySamplerAgreesInTheMean) {
    const Lens lens{1, 1};
    constexpr double edge_px = 30.3, depth_m = 2.5;
    const auto expected = edge_columns(edge_px, lens.coc_px(depth_m), 0, 1);
    const Scene scene = half_plane(edge_px, depth_m).scene;
    for (const SamplerKind kind :
         {SamplerKind::random, SamplerKind::jittered, SamplerKind::poisson, SamplerKind::sobol}) {
        // spp need not be a square number or a power of two.
        for (const int spp : {12, 25}) {
            expect_figures(repeated(scene, through(lens, spp, kind), column_means), expected, rounding,
                           "a sampler");
        }
    }
}

// With a pinhole and a vertical edge, whole columns of an n x n grid lie on one side of the edge, so the
// error of a pixel is at most half a column. With a lens, the grid of spp cells on the lens adds the cells
// that the edge crosses: at most 2 n of n x n.
TEST(OutOfFocus, AGridErrsByNoMoreThanItsCells) {
    constexpr int n = 8;
    for (const double edge_px : {30.0, 30.3, 30.71}) {
        RenderSettings s = through({1, 1}, n * n, SamplerKind::grid);
        s.f_number = std::numeric_limits<double>::infinity();
        const std::vector<double> got = column_means(render_picture(half_plane(edge_px, 2).scene, s).image);
        for (int x = 0; x < width; ++x) {
            const double expected = std::clamp(x + 1 - edge_px, 0.0, 1.0);
            EXPECT_NEAR(got[static_cast<std::size_t>(x)], expected, 0.5 / n + rounding);
        }
    }
    const Lens lens{1, 1};
    const auto expected = edge_columns(30.3, lens.coc_px(2.5), 0, 1);
    const auto got =
        repeated(half_plane(30.3, 2.5).scene, through(lens, n * n, SamplerKind::grid), column_means);
    for (std::size_t x = 0; x < expected.size(); ++x) {
        EXPECT_NEAR(got[x].mean, expected[x], 2.0 / n * 0.5 + 0.5 / n) << x;
        // The mean is much more accurate, because errors of cells cancel: within a quarter of a cell's width.
        EXPECT_NEAR(got[x].mean, expected[x], 4 * got[x].standard_error + 0.25 / n) << x;
    }
}

// The fraction of the exposure during which a bar of width w covers x, while its left side moves from a to
// a + d.
double trapezoid(double x, double a, double w, double d) {
    // The profile is a trapezoid of height min(1, w / d), with a plateau of width |d - w| and a base of width
    // d + w.
    const double from_middle = std::abs(x - (a + 0.5 * (w + d)));
    const double foot = 0.5 * (d + w), plateau = 0.5 * std::abs(d - w), top = std::min(1.0, w / d);
    if (from_middle >= foot) return 0;
    return from_middle <= plateau ? top : top * (foot - from_middle) / (foot - plateau);
}

// Fraction of the light that a shutter with a triangular curve has transmitted by time t: 2 t^2 for t < 1/2,
// then 1 - 2 (1 - t)^2.
double triangle_light(double t) {
    const double u = std::clamp(t, 0.0, 1.0);
    return u < 0.5 ? 2 * u * u : 1 - 2 * (1 - u) * (1 - u);
}
double under_triangle(double x, double a, double w, double d) {
    // The bar covers x while a + d t <= x <= a + d t + w.
    return triangle_light((x - a) / d) - triangle_light((x - w - a) / d);
}

std::vector<double> bar_columns(const std::function<double(double)>& share) {
    std::vector<double> out;
    for (int x = 0; x < width; ++x) out.push_back(mean_over(x, x + 1, share));
    return out;
}

constexpr double bar_depth_m = 3, opens_s = 2, closes_s = 2.5;

enum class Moves { object, mesh, camera };

SceneBuilder bar(double a_px, double w_px, double d_px, Moves what) {
    SceneBuilder b = strip();
    const Rectangle r = upright(a_px, a_px + w_px, bar_depth_m);
    Shape shape = r;
    if (what == Moves::mesh) {
        auto mesh = std::make_shared<Mesh>();
        for (const dvec3& p :
             {r.corner, r.corner + r.edge_u, r.corner + r.edge_u + r.edge_v, r.corner + r.edge_v})
            mesh->positions.emplace_back(p);
        mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
        shape = std::shared_ptr<const Mesh>(mesh);
    }
    Object& o = b.add(shape, glowing(dvec3(1)));
    // The keys lie before the opening and after the closing, so the shutter exposes only a part of the
    // motion.
    std::vector<TransformKey> keys(2);
    keys[0].time_s = opens_s - (closes_s - opens_s);
    keys[1].time_s = closes_s + (closes_s - opens_s);
    const double way = (what == Moves::camera ? -1 : 1) * d_px / gain_px * bar_depth_m;
    keys[0].translation.x = -way;
    keys[1].translation.x = 2 * way;
    (what == Moves::camera ? b.scene.cameras[0].keys : o.keys) = keys;
    return b;
}

RenderSettings open_shutter(const ShutterCurve& curve) {
    RenderSettings s;
    s.shutter = TimeSpan{opens_s, closes_s};
    s.curve = curve;
    s.spp = 64;
    return s;
}

struct Sweep {
    double a_px, w_px, d_px;
};
// Bars that move by less than their width, by their width, by more, and by far less than a pixel. The ends of
// the paths are chosen so that no pixel gets so little light that all of its samples may miss it.
constexpr std::array<Sweep, 4> sweeps{
    {{20.2, 9.3, 5.1}, {15.6, 8.25, 8.25}, {12.2, 3.3, 30.4}, {31.3, 4.2, 0.2}}};

// Vertices of a mesh are floats with an error of 2^-24 of 150 m (half its height), which has no effect on the
// vertical sides of a bar. Times of rays are multiples of 2^-24 of the motion.
constexpr double motion_rounding = 2e-5;

TEST(InMotion, ABarUnderABoxShutterIsATrapezoid) {
    for (const Sweep& s : sweeps) {
        const auto expected = bar_columns([&](double x) { return trapezoid(x, s.a_px, s.w_px, s.d_px); });
        for (const Moves what : {Moves::object, Moves::mesh, Moves::camera}) {
            const auto got = repeated(bar(s.a_px, s.w_px, s.d_px, what).scene,
                                      open_shutter(ShutterCurve::box()), column_means);
            expect_figures(got, expected, motion_rounding,
                           what == Moves::object ? "object"
                           : what == Moves::mesh ? "mesh"
                                                 : "camera");
        }
    }
}

TEST(InMotion, ABarUnderATriangleShutter) {
    for (const Sweep& s : {sweeps[0], sweeps[2]}) {
        const auto expected =
            bar_columns([&](double x) { return under_triangle(x, s.a_px, s.w_px, s.d_px); });
        for (const Moves what : {Moves::object, Moves::mesh, Moves::camera}) {
            const auto got = repeated(bar(s.a_px, s.w_px, s.d_px, what).scene,
                                      open_shutter(ShutterCurve::triangle()), column_means);
            expect_figures(got, expected, motion_rounding, "triangle shutter");
        }
    }
}

TEST(InMotion, EverySamplerAgreesInTheMean) {
    const Sweep& s = sweeps[2];
    const auto expected = bar_columns([&](double x) { return trapezoid(x, s.a_px, s.w_px, s.d_px); });
    for (const SamplerKind kind : {SamplerKind::random, SamplerKind::jittered, SamplerKind::poisson}) {
        RenderSettings settings = open_shutter(ShutterCurve::box());
        settings.sampler = kind;
        settings.spp = 20;
        expect_figures(repeated(bar(s.a_px, s.w_px, s.d_px, Moves::object).scene, settings, column_means),
                       expected, motion_rounding, "a sampler");
    }
}

// The sum over the image and the centroid.
std::vector<double> sum_and_centroid(const Image& image) {
    double sum = 0, sx = 0, sy = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto v = static_cast<double>(image.pixel(x, y)[0]);
            sum += v, sx += v * (x + 0.5), sy += v * (y + 0.5);
        }
    }
    return {sum, sx / sum, sy / sum};
}

// Centroid, by pixel centres, of a disc of radius r that is blurred by a disc of radius coc_radius. The
// density of a disc across the raster is sqrt(r^2 - x^2); the fraction of its light beyond a pixel's border
// is the disc's edge profile.
double seen_centroid(double centre, double radius, double coc_radius, int pixels_across) {
    constexpr int n = 2000;
    double sum = 0, weights = 0;
    for (int i = 0; i < n; ++i) {
        const double b = (i + 0.5) / n * 2 - 1, weight = std::sqrt(1 - b * b);
        double pixel = 0.5;
        for (int k = 1; k < pixels_across; ++k) pixel += disc_edge(centre + coc_radius * b - k, radius);
        sum += weight * pixel;
        weights += weight;
    }
    return sum / weights;
}

// A small disc that faces the camera has the same size in the view of every lens point, so its light is
// conserved exactly. Its area is pi r^2 px^2.
TEST(OutOfFocus, APointLightKeepsItsLightAndItsPlace) {
    SceneBuilder b;
    Camera& c = b.scene.cameras[0];
    c.width = c.height = 24;
    c.film_width_mm = film_width_mm * 24 / width;  // the same pixels
    c.focal_length_mm = film_distance_mm;
    constexpr double radius_px = 2, depth_m = 2, x_px = 11.3, y_px = 12.4, radiance = 50;
    b.add(Disc{{(x_px - 12) / gain_px * depth_m, -(y_px - 12) / gain_px * depth_m, -depth_m},
               {0, 0, 1},
               radius_px / gain_px * depth_m,
               0},
          glowing(dvec3(radiance)));
    const double light = std::numbers::pi * radius_px * radius_px * radiance;
    for (const Lens& lens : {Lens{1, depth_m}, Lens{1, 1.1}, Lens{1.5, 5}}) {
        EXPECT_LT(lens.coc_px(depth_m) / 2 + radius_px, 11) << "it should stay within the frame";
        const auto got = repeated(b.scene, through(lens, 256), sum_and_centroid);
        const double coc_radius_px = lens.coc_px(depth_m) / 2;
        expect_figures(got,
                       {light, seen_centroid(x_px, radius_px, coc_radius_px, c.width),
                        seen_centroid(y_px, radius_px, coc_radius_px, c.height)},
                       24 * rounding, "a light");
        EXPECT_NEAR(got[0].mean, light, 1e-3 * light);
        EXPECT_NEAR(got[1].mean, x_px, 0.01);
        EXPECT_NEAR(got[2].mean, y_px, 0.01);
    }
    EXPECT_GT((Lens{1, 1.1}.coc_px(depth_m)), 7);
}

}  // namespace
}  // namespace postlens::test::closed_form_test
