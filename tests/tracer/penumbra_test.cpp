// Penumbrae: points on extended lights, and shadows of still and moving lights.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tests/tracer/floor_scene.h"
#include "tests/tracer/repeated_renders.h"
#include "tracer/camera_model.h"
#include "tracer/shading/shading.h"

namespace postlens::test::penumbra_test {
namespace {

using glm::dvec2;
using glm::dvec3;

// The centre of cell i of n x n cells in the unit square.
dvec2 cell_middle(int i, int n) {
    const int row = i / n, column = i % n;
    return (dvec2(column, row) + 0.5) / static_cast<double>(n);
}

// The mean of `shown` over the floor points of each pixel. Six by six points per pixel are exact for smooth
// functions. Their error at kinks of a penumbra is below 1e-3: the square of pixel size over penumbra width.
std::vector<double> floor_pixels(const Scene& scene, const std::function<double(const dvec3&)>& shown) {
    const CameraModel camera(scene.cameras[0], 0);
    std::vector<double> out;
    constexpr int n = 6;
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            double sum = 0;
            for (int i = 0; i < n * n; ++i) {
                const dvec2 in_pixel = cell_middle(i, n);
                const CameraRay r = camera.ray(x + in_pixel.x, y + in_pixel.y);
                sum += shown(r.origin - r.direction * (r.origin.y / r.direction.y));
            }
            out.push_back(sum / (n * n));
        }
    }
    return out;
}

// An opaque black half-plane above the right half of the floor, halfway to the light.
constexpr double occluder_height = 1, light_height = 2;
void add_half_plane(SceneBuilder& b) {
    b.add(Rectangle{{0, occluder_height, -50}, {0, 0, 100}, {50, 0, 0}}, matte(dvec3(0)));
}
// Whether the segment from the floor to the light misses the half-plane.
bool open(const dvec3& floor, const dvec3& light) {
    const double share = occluder_height / light.y;
    return floor.x + share * (light.x - floor.x) < 0;
}

TEST(Penumbra, OfARectangleIsTheShareOfItsArea) {
    SceneBuilder b = floor_scene();
    add_half_plane(b);
    Light& l = b.point_light({0.1, light_height, 0.2}, dvec3(2));
    l.kind = Light::Kind::rectangle;
    l.edge_u = {0.8, 0.1, 0};
    l.edge_v = {0, 0, 0.5};
    const Light light = l;
    const auto expected = floor_pixels(b.scene, [&](const dvec3& p) {
        double sum = 0;
        constexpr int n = 100;
        for (int i = 0; i < n * n; ++i) {
            const dvec2 cell = cell_middle(i, n) - 0.5;
            const dvec3 at = light.position + cell.x * light.edge_u + cell.y * light.edge_v;
            if (open(p, at)) sum += 2 * glm::normalize(at - p).y;
        }
        return sum / (n * n);
    });
    // Error of the quadrature: the shadow's border crosses 100 rows of the light for each of 36 points. Each
    // has an error of at most half a cell, of either sign: 2 / 100 / sqrt(36) / 2.
    expect_figures(repeated(b.scene, pinhole(64), pixels), expected, 2e-3, "rectangle");
    EXPECT_LT(*std::min_element(expected.begin(), expected.end()), 0.1);
    EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1.5);
}

TEST(Penumbra, OfASphereIsTheShareOfItsSolidAngle) {
    SceneBuilder b = floor_scene();
    add_half_plane(b);
    Light& l = b.point_light({-0.1, light_height, 0.3}, dvec3(2));
    l.kind = Light::Kind::sphere;
    l.radius = 0.5;
    const Light light = l;
    const auto expected = floor_pixels(b.scene, [&](const dvec3& p) {
        // Directions that are uniform in the cone: rings of equal solid angle, sectors of equal angle.
        const dvec3 axis = glm::normalize(light.position - p);
        const dvec3 x = glm::normalize(glm::cross(axis, dvec3(0, 0, 1))), y = glm::cross(axis, x);
        const double sine = light.radius / glm::length(light.position - p);
        const double lowest = std::sqrt(1 - sine * sine);
        double sum = 0;
        constexpr int n = 100;
        for (int i = 0; i < n * n; ++i) {
            const dvec2 cell = cell_middle(i, n);
            const double c = 1 - (1 - lowest) * cell.x, s = std::sqrt(1 - c * c);
            const double turn = 2 * std::numbers::pi * cell.y;
            const dvec3 d = c * axis + s * std::cos(turn) * x + s * std::sin(turn) * y;
            // The direction crosses the half-plane's height before it reaches the light.
            if (p.x + d.x / d.y * occluder_height < 0) sum += 2 * d.y;
        }
        return sum / (n * n);
    });
    expect_figures(repeated(b.scene, pinhole(64), pixels), expected, 2e-3, "sphere");
    EXPECT_LT(*std::min_element(expected.begin(), expected.end()), 0.1);
    EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1.5);
}

TEST(Penumbra, VanishesWithTheLight) {
    std::array<Image, 3> pictures;
    for (std::size_t i = 0; i < 3; ++i) {
        SceneBuilder b = floor_scene(32, 4);
        add_half_plane(b);
        Light& l = b.point_light({0.1, light_height, 0.2}, dvec3(1));
        l.attenuation = {0.5, 0.1, 0.2};
        if (i == 1) {
            l.kind = Light::Kind::sphere;
            l.radius = 1e-9;
        }
        if (i == 2) {
            l.kind = Light::Kind::rectangle;
            l.edge_u = {1e-9, 0, 0};
            l.edge_v = {0, 0, 1e-9};
        }
        pictures[i] = render_picture(b.scene, pinhole(16)).image;
    }
    // Shadow rays are floats, so images could differ at a sample exactly on a shadow edge; none is there.
    for (std::size_t k = 0; k < pictures[0].rgb.size(); ++k) {
        EXPECT_NEAR(pictures[1].rgb[k], pictures[0].rgb[k], 1e-6F);
        EXPECT_NEAR(pictures[2].rgb[k], pictures[0].rgb[k], 1e-6F);
    }
}

TEST(LightPoints, OfASphereAreEvenOverTheSolidAngleAndOnItsNearSide) {
    Light l;
    l.kind = Light::Kind::sphere;
    l.radius = 0.7;
    l.position = {1, -2, 0.5};
    const PlacedLight placed = place_light(l, 0.0);
    RandomNumbers random(21);
    for (const double distance : {0.7001, 1.0, 5.0, 1e4}) {
        const dvec3 from = l.position + distance * random.direction();
        const dvec3 axis = glm::normalize(l.position - from);
        const dvec3 x = glm::normalize(glm::cross(axis, dvec3(0.3, 0.5, 0.9))), y = glm::cross(axis, x);
        const double sine = l.radius / distance, widest = sine * sine / (1 + std::sqrt(1 - sine * sine));
        constexpr int rings = 8, sectors = 16, n = 1 << 15;
        std::vector<int> count(rings * sectors, 0);
        for (int i = 0; i < n; ++i) {
            const dvec3 p = light_point(placed, from, {random.in(0, 1), random.in(0, 1)});
            // The square root near the outline has an error of 2^-26 of the distance.
            EXPECT_NEAR(glm::length(p - l.position), l.radius, 2e-8 * distance);
            EXPECT_LE(glm::dot(p - l.position, p - from), 1e-7 * distance * distance);  // faces `from`
            const dvec3 d = p - from;
            const double across2 = glm::dot(d, x) * glm::dot(d, x) + glm::dot(d, y) * glm::dot(d, y);
            const double sine2 = across2 / glm::dot(d, d);
            const double lowered = sine2 / (1 + std::sqrt(1 - std::min(1.0, sine2)));  // 1 - cos
            const double turn = std::atan2(glm::dot(d, y), glm::dot(d, x)) / (2 * std::numbers::pi) + 0.5;
            const int ring = std::min(static_cast<int>(lowered / widest * rings), rings - 1);
            const int sector = std::min(static_cast<int>(turn * sectors), sectors - 1);
            ++count[static_cast<std::size_t>(ring * sectors + sector)];
        }
        const double expected = static_cast<double>(n) / (rings * sectors);
        double statistic = 0;
        for (const int c : count) statistic += (c - expected) * (c - expected) / expected;
        constexpr double freedom = rings * sectors - 1;
        EXPECT_LE(statistic, freedom + 4 * std::sqrt(2 * freedom)) << "at " << distance;
        EXPECT_GE(statistic, freedom - 4 * std::sqrt(2 * freedom)) << "at " << distance;
    }
    // From inside of the sphere there is no outline, so its centre is returned.
    EXPECT_EQ(light_point(placed, l.position + dvec3(0.1, 0, 0), {0.3, 0.4}), l.position);
    EXPECT_EQ(light_point(placed, l.position, {0.3, 0.4}), l.position);
}

TEST(LightPoints, OfARectangleAreOnIt) {
    Light l;
    l.kind = Light::Kind::rectangle;
    l.position = {1, 2, 3};
    l.edge_u = {2, 0, 0};
    l.edge_v = {0, 0, 4};
    const PlacedLight placed = place_light(l, 0.0);
    EXPECT_EQ(light_point(placed, dvec3(9), {0, 0}), dvec3(0, 2, 1));
    EXPECT_EQ(light_point(placed, dvec3(9), {0.5, 0.5}), l.position);
    EXPECT_EQ(light_point(placed, dvec3(9), {1, 0.25}), dvec3(2, 2, 2));
}

TEST(LightsInMotion, GiveTheMeanOverTime) {
    SceneBuilder b = floor_scene();
    Light& l = b.point_light(dvec3(0), dvec3(1));
    l.keys.resize(2);
    l.keys[0].time_s = 1;
    l.keys[0].translation = {-2, 1, 0};
    l.keys[1].time_s = 3;
    l.keys[1].translation = {2, 1.5, 1};
    const std::vector<TransformKey> keys = l.keys;
    // Only the light moves, and the shutter exposes a part of its motion.
    RenderSettings s = pinhole(64);
    s.shutter = TimeSpan{1.2, 2.7};
    for (const bool triangle : {false, true}) {
        s.curve = triangle ? ShutterCurve::triangle() : ShutterCurve::box();
        const auto expected = floor_pixels(b.scene, [&](const dvec3& p) {
            return mean_over(
                0, 1,
                [&](double t) {
                    const double weight = !triangle ? 1 : t < 0.5 ? 4 * t : 4 * (1 - t);
                    const dvec3 at(transform_at(keys, 1.2 + 1.5 * t)[3]);
                    return weight * glm::normalize(at - p).y;
                },
                200);
        });
        // The integrand is smooth, so errors of the quadratures are the squares of their steps: 1/200 of the
        // time and 1/6 of a pixel of 5 cm.
        expect_figures(repeated(b.scene, s, pixels), expected, 2e-4, "light in motion");
    }
    s.shutter.reset();
    s.time_s = 2;  // an instant, without averaging over time
    const Image still = render_picture(b.scene, s).image;
    const auto expected = floor_pixels(
        b.scene, [&](const dvec3& p) { return glm::normalize(dvec3(transform_at(keys, 2)[3]) - p).y; });
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(static_cast<double>(still.rgb[3 * i]), expected[i],
                    3e-3);  // noise of 64 samples in a smooth pixel
}

// With light from straight above, the shadow of a moving bar is the trapezoid of the bar.
TEST(ShadowsInMotion, FallAtTheRightInstant) {
    constexpr double width_m = 0.15, way_m = 0.5, start_m = -0.3;
    for (const bool mesh : {false, true}) {
        SceneBuilder b = floor_scene(32, 2);
        Light& sun = b.point_light(dvec3(0));
        sun.kind = Light::Kind::directional;
        sun.direction = {0, -1, 0};
        // The bar is high above, outside of the camera's view.
        Shape shape = Box{{0, 8, -20}, {width_m, 8.01, 20}};
        if (mesh) {
            auto m = std::make_shared<Mesh>();
            m->positions = {{0, 8, -20}, {width_m, 8, -20}, {width_m, 8, 20}, {0, 8, 20}};
            m->triangles = {{0, 1, 2}, {0, 2, 3}};
            shape = std::shared_ptr<const Mesh>(m);
        }
        Object& o = b.add(shape, matte(dvec3(0)));
        o.keys.resize(3);  // half of the path in a quarter of the time
        o.keys[0].translation.x = start_m;
        o.keys[1].time_s = 0.25;
        o.keys[1].translation.x = start_m + way_m / 2;
        o.keys[2].time_s = 1;
        o.keys[2].translation.x = start_m + way_m;
        const std::vector<TransformKey> keys = o.keys;
        RenderSettings s = pinhole(64);
        s.shutter = TimeSpan{0, 1};
        const auto expected = floor_pixels(b.scene, [&](const dvec3& p) {
            return mean_over(
                0, 1,
                [&](double t) {
                    const double left = transform_at(keys, t)[3].x;
                    return p.x > left && p.x < left + width_m ? 0.0 : 1.0;
                },
                2000);
        });
        // The quadrature over time has an error of at most one step, 1 / 2000, per border.
        expect_figures(repeated(b.scene, s, pixels), expected, 1e-3, mesh ? "mesh" : "box");
        EXPECT_LT(*std::min_element(expected.begin(), expected.end()), 0.8);
    }
}

}  // namespace
}  // namespace postlens::test::penumbra_test
