// Distributed rays: gloss, translucency, and where shading trees end.
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <vector>

#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tests/tracer/floor_scene.h"
#include "tests/tracer/repeated_renders.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens::test::distributed_test {
namespace {

using glm::dvec3;

constexpr double infinity = std::numeric_limits<double>::infinity();

// A camera with a very narrow field of view, whose rays are almost parallel to the axis: directions differ by
// less than 4e-4, and positions at a distance of 1 m by less than 4e-4 m.
SceneBuilder narrow_view() {
    SceneBuilder b;
    Camera& c = b.scene.cameras[0];
    c.width = c.height = 4;
    c.focal_length_mm = 50000;
    return b;
}

// The mean of the red channel.
std::vector<double> whole_mean(const Image& image) {
    double sum = 0;
    for (const double v : pixels(image)) sum += v;
    const std::size_t count = image.rgb.size() / 3;
    return {sum / static_cast<double>(count)};
}

// Of a lobe (n + 1) / (2 pi) cos^n about the axis, the fraction 1 - cos^(n + 1)(alpha) lies within the angle
// alpha. The axis varies by less than 4e-4 over the film, which changes the fraction by less than 4e-4 times
// its slope, (n + 1) sin(alpha) cos^n(alpha) <= sqrt(n + 1), with either sign.
void expect_lobe(const Scene& scene, double exponent, double alpha) {
    const double share = 1 - std::pow(std::cos(alpha), exponent + 1);
    expect_figures(repeated(scene, pinhole(256), whole_mean), {share}, 1e-4 * std::sqrt(exponent + 1),
                   "lobe");
}

TEST(Gloss, OfAMirrorIsTheCosineLobe) {
    for (const double exponent : {0.0, 1.0, 10.0, 300.0}) {
        for (const double alpha : {0.05, 0.3, 1.2}) {
            SceneBuilder b = narrow_view();
            Material m = mirror();
            m.reflection_exponent = exponent;
            b.add(square({0, 0, -1}, {0, 0, 1}, 2), m);
            b.add(Disc{{0, 0, 1}, {0, 0, 1}, 2 * std::tan(alpha), 0}, glowing(dvec3(1)));
            expect_lobe(b.scene, exponent, alpha);
        }
    }
}

TEST(Translucency, OfASheetIsTheCosineLobe) {
    for (const double exponent : {1.0, 40.0}) {
        for (const double alpha : {0.1, 0.7}) {
            SceneBuilder b = narrow_view();
            Material m = glass(1);
            m.transmission_exponent = exponent;
            b.add(square({0, 0, -1}, {0, 0, 1}, 2), m);
            b.add(Disc{{0, 0, -3}, {0, 0, 1}, 2 * std::tan(alpha), 0}, glowing(dvec3(1)));
            expect_lobe(b.scene, exponent, alpha);
        }
    }
}

// The lobe is centred on the mirrored direction of a tilted mirror.
TEST(Gloss, FollowsTheMirrorsDirection) {
    SceneBuilder b = narrow_view();
    Material m = mirror();
    m.reflection_exponent = 500;
    b.add(square({0, 0, -1}, {1, 0, 1}, 2), m);  // reflects the optical axis to +x
    b.add(Disc{{2, 0, -1}, {1, 0, 0}, 2 * std::tan(0.06), 0}, glowing(dvec3(1)));
    expect_lobe(b.scene, 500, 0.06);
    EXPECT_EQ(spread_direction({0, 0.6, 0.8}, infinity, {0.3, 0.3}), dvec3(0, 0.6, 0.8));
    RandomNumbers random(31);
    for (int i = 0; i < 100; ++i) {
        const dvec3 axis = random.direction();
        const dvec3 d = spread_direction(axis, 1e12, {random.in(0, 1 - 1e-9), random.in(0, 1)});
        EXPECT_NEAR(glm::length(d), 1, 1e-14);
        EXPECT_LE(glm::length(d - axis), 1e-5);  // sqrt(2 ln(1e9) / 1e12) = 6e-6
    }
}

TEST(Gloss, NoSpreadIsTheExactMirror) {
    const auto scene = [](double exponent) {
        SceneBuilder b;
        b.scene.cameras[0].width = 24;
        b.scene.cameras[0].height = 16;
        Material m = mirror(0.8);
        m.transmission = dvec3(0.2);
        m.ior = 1.3;
        m.reflection_exponent = m.transmission_exponent = exponent;
        b.add(Sphere{{0, 0, -4}, 1}, m);
        Material wall = glowing({1, 0.5, 0.2});
        wall.emission_texture = std::make_shared<Texture>(Checker{});
        b.add(Sphere{{0, 0, 0}, 20}, wall);
        return b;
    };
    const Image exact = render_picture(scene(infinity).scene, pinhole(16)).image;
    // An exponent of 1e12, the largest that a scene may have, spreads directions by about 1e-6. This moves
    // the borders of the checker by 1e-5 of their distance.
    const Image nearly = render_picture(scene(1e12).scene, pinhole(16)).image;
    double difference = 0;
    for (std::size_t i = 0; i < exact.rgb.size(); ++i)
        difference += std::abs(static_cast<double>(exact.rgb[i] - nearly.rgb[i]));
    EXPECT_LE(difference / static_cast<double>(exact.rgb.size()), 1e-3);
    EXPECT_NE(exact.rgb, render_picture(scene(50).scene, pinhole(16)).image.rgb);
}

// In uniform radiance, a lossless mirror has the radiance of its surroundings, for any lobe and at any angle.
TEST(Gloss, LosesNoLight) {
    for (const double exponent : {0.0, 1.0, 20.0, 1e4, infinity}) {
        SceneBuilder b;
        b.scene.background = dvec3(1);
        b.scene.cameras[0].width = 24;
        b.scene.cameras[0].height = 16;
        Material m = mirror();
        m.reflection_exponent = exponent;
        b.add(Plane{{0, -1e-3, 0}, {0, 1, 0}}, m);  // seen at all angles down to grazing
        b.add(Sphere{{0, 0.4, -4}, 0.3}, m);
        RenderSettings s = pinhole(16);
        // A path may be reflected between ball and floor many times. Light beyond 16 bounces is lost, but it
        // is negligible.
        s.tracing.max_depth = 17;
        s.tracing.min_contribution = 0;
        const Image image = render_picture(b.scene, s).image;
        for (const float v : image.rgb) EXPECT_NEAR(v, 1, 1e-2) << exponent;
        EXPECT_NEAR(whole_mean(image)[0], 1, 1e-4) << exponent;
    }
}

TEST(Translucency, LosesNoLight) {
    for (const double exponent : {0.0, 5.0, infinity}) {
        SceneBuilder b;
        b.scene.background = dvec3(1);
        b.scene.cameras[0].width = 24;
        b.scene.cameras[0].height = 16;
        Material m = glass(1);
        m.transmission_exponent = exponent;
        b.add(square({0, 0, -2}, {0.9, 0, 0.1}, 20), m);
        const Image image = render_picture(b.scene, pinhole(16)).image;
        for (const float v : image.rgb) EXPECT_NEAR(v, 1, 1e-6F) << exponent;
    }
}

// Two emitting mirrors face each other, so that each further node contributes half of the one before.
TEST(Trees, EndAtTheDepthAskedFor) {
    SceneBuilder b;
    b.scene.cameras[0].width = b.scene.cameras[0].height = 4;
    Material m = mirror(1);
    m.emission = dvec3(0.25);
    b.add(Plane{{0, 0, -1}, {0, 0, 1}}, m);
    b.add(Plane{{0, 0, 1}, {0, 0, -1}}, m);
    for (const int depth : {1, 2, 5, 17}) {
        RenderSettings s = pinhole(4);
        s.tracing.max_depth = depth;
        const RenderResult r = render_picture(b.scene, s);
        for (const float v : r.image.rgb) EXPECT_EQ(v, 0.25F * static_cast<float>(depth));
        EXPECT_EQ(r.rays.eye, 64U);
        EXPECT_EQ(r.rays.eye_hits, 64U);
        EXPECT_EQ(r.rays.reflect, 64U * static_cast<unsigned>(depth - 1));
        EXPECT_EQ(r.rays.refract, 0U);
        EXPECT_EQ(r.rays.shadow, 0U);
    }
}

TEST(Trees, EndWhereTooLittleWouldCome) {
    SceneBuilder b;
    b.scene.cameras[0].width = b.scene.cameras[0].height = 4;
    Material m = mirror(0.5);
    m.emission = dvec3(1);
    b.add(Plane{{0, 0, -1}, {0, 0, 1}}, m);
    b.add(Plane{{0, 0, 1}, {0, 0, -1}}, m);
    RenderSettings s = pinhole(4);
    s.tracing.max_depth = 17;
    s.tracing.min_contribution = 0;
    const RenderResult all = render_picture(b.scene, s);
    // The sum 1 + 1/2 + ... + 1/2^16 is exact in float.
    EXPECT_EQ(all.image.rgb[0], 2 - 0x1p-16F);
    s.tracing.min_contribution = 0.01;
    const RenderResult cut = render_picture(b.scene, s);
    EXPECT_LT(cut.image.rgb[0], all.image.rgb[0]);
    EXPECT_GE(cut.image.rgb[0], all.image.rgb[0] - 0.01F);
    EXPECT_LT(cut.rays.reflect, all.rays.reflect);
    // A subtree of throughput 2^-k contributes less than 2^(1 - k), which is below 0.01 from k = 8 on.
    EXPECT_EQ(cut.rays.reflect, 64U * 7U);
}

}  // namespace
}  // namespace postlens::test::distributed_test
