// Whitted shading and shading trees against closed forms.
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/support/scene_builder.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/radiance_bounds.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test::tracer_test {
namespace {

using glm::dvec2;
using glm::dvec3;

std::vector<Record> trace_at(const Scene& scene, dvec2 at,
                             const WhittedSettings& settings = {.min_contribution = 0},
                             RayCounts* counts_out = nullptr) {
    const RayScene rays(scene, scene.time_s);
    const CameraModel camera(scene.cameras.at(0), scene.time_s);
    TracedSamples traced;
    RayCounts counts;
    WhittedTracer(rays, camera, settings).trace(std::vector<dvec2>{at}, traced, counts);
    if (counts_out != nullptr) *counts_out = counts;
    return traced.records;
}

dvec3 colour(const std::vector<Record>& records) {
    dvec3 sum(0);
    for (const Record& r : records) sum += dvec3(r.r, r.g, r.b);
    return sum;
}

const dvec2 centre{32, 24};  // the optical axis of SceneBuilder's camera

TEST(Shading, LambertPhongAmbientAndEmissionAddUp) {
    SceneBuilder b;
    Material m = matte({0.5, 0.25, 0.1});
    m.ambient = dvec3(0.2, 0.3, 0.4);
    m.emission = dvec3(1, 0, 0);
    m.specular = dvec3(0.7);
    m.shininess = 10;
    b.add(square({0, 0, -4}, {0, 0, 1}, 2), m);
    b.scene.ambient_light = dvec3(0.5);
    b.point_light({3, 0, 0}, dvec3(2, 1, 1));
    // The cosine between light and normal is 4 / 5, and so is that between mirrored direction and eye.
    const double n_l = 0.8, r_v = 0.8;
    const dvec3 expected = dvec3(1, 0, 0) + dvec3(0.1, 0.15, 0.2) +
                           dvec3(2, 1, 1) * (dvec3(0.5, 0.25, 0.1) * n_l + 0.7 * std::pow(r_v, 10));
    const dvec3 got = colour(trace_at(b.scene, centre));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], 1e-6);
}

TEST(Shading, AttenuationSpotAndDirectional) {
    SceneBuilder b;
    b.add(square({0, 0, -4}, {0, 0, 1}, 20), matte(dvec3(1)));
    Light& l = b.point_light({0, 0, -1});
    l.attenuation = {1, 2, 3};  // 1 / (1 + 2 * 3 + 3 * 9)
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, 1 / 34.0, 1e-7);

    l.attenuation = {1, 0, 0};
    l.kind = Light::Kind::spot;
    l.direction = dvec3(0, 0, -1);
    l.cone_degrees = 60;
    l.cone_soft_degrees = 20;
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, 1, 1e-6);
    l.position = {3, 0, -1};  // the surface is at 45 degrees to the light's axis, outside of its cone
    EXPECT_EQ(colour(trace_at(b.scene, centre)).x, 0);
    l.direction = glm::normalize(dvec3(-1, 0, -1) + dvec3(0.3, 0, 0));
    const double soft = colour(trace_at(b.scene, centre)).x;
    EXPECT_GT(soft, 0);
    EXPECT_LT(soft, std::sqrt(0.5));

    l.kind = Light::Kind::directional;
    l.direction = glm::normalize(dvec3(1, 0, -1));
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, std::sqrt(0.5), 1e-6);
}

TEST(Shading, LightFromBehindPassesByItsCosineTerm) {
    SceneBuilder b;
    Material m = matte(dvec3(0.9));
    m.diffuse_transmission = dvec3(0.1, 0.2, 0.3);
    b.add(square({0, 0, -4}, {0, 0, 1}, 2), m);
    b.point_light({3, 0, -8});
    const dvec3 got = colour(trace_at(b.scene, centre));
    EXPECT_NEAR(got.x, 0.1 * 0.8, 1e-6);
    EXPECT_NEAR(got.z, 0.3 * 0.8, 1e-6);
    b.scene.materials[0].diffuse_transmission = dvec3(0);
    EXPECT_EQ(colour(trace_at(b.scene, centre)).x, 0);
}

TEST(Shadows, OpaqueStopsGlassColoursAndLampsLetPass) {
    SceneBuilder b;
    b.add(square({0, 0, -4}, {0, 0, 1}, 20), matte(dvec3(1)));
    b.point_light({0, 3, -4 + 3.0});
    const double free = colour(trace_at(b.scene, centre)).x;
    EXPECT_NEAR(free, std::sqrt(0.5), 1e-6);
    Material filter = glass(1, 1);
    filter.transmission = dvec3(0.5, 0.25, 1);
    Object& blocker = b.add(Sphere{{0, 1.5, -2.5}, 0.2}, filter);
    dvec3 got = colour(trace_at(b.scene, centre));
    // The shadow ray crosses two surfaces, on entering and on leaving.
    EXPECT_NEAR(got.x, free * 0.25, 1e-6);
    EXPECT_NEAR(got.y, free * 0.0625, 1e-6);
    EXPECT_NEAR(got.z, free, 1e-6);
    // A sheet has one crossing, a box and a mesh have two.
    blocker.shape = square({0, 1.5, -2.5}, {0, 1, 1}, 0.5);
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, free * 0.5, 1e-6);
    blocker.shape = Box{{-0.2, 1.3, -2.7}, {0.2, 1.7, -2.3}};
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, free * 0.25, 1e-6);
    blocker.shape = sphere_mesh(9, 14, false);
    blocker.world_from_object =
        glm::scale(glm::translate(glm::dmat4(1), dvec3(0.013, 1.52, -2.49)), dvec3(0.3));
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, free * 0.25, 1e-6);
    b.scene.objects[1].casts_shadows = false;
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, free, 1e-6);
    b.scene.objects[1].casts_shadows = true;
    b.scene.materials[1].transmission = dvec3(0);
    EXPECT_EQ(colour(trace_at(b.scene, centre)), dvec3(0));
    b.scene.lights[0].casts_shadows = false;
    EXPECT_NEAR(colour(trace_at(b.scene, centre)).x, free, 1e-6);
}

TEST(Tree, MirrorAndGlassWeighTheirChildren) {
    SceneBuilder b;
    Material m = matte(dvec3(0));
    m.emission = dvec3(0.125);
    m.reflection = dvec3(0.25, 0.5, 0.5);
    m.transmission = dvec3(0.5, 0.25, 0.25);
    m.ior = 1;
    b.add(square({0, 0, -4}, {0, 0, 1}, 2), m);
    b.add(square({0, 0, 2}, {0, 0, -1}, 20), glowing(dvec3(8)));
    b.add(square({0, 0, -6}, {0, 0, 1}, 20), glowing(dvec3(2)));
    const auto records = trace_at(b.scene, centre);
    ASSERT_EQ(records.size(), 3U);
    EXPECT_EQ(records[0].path.bits(), 0U);
    EXPECT_EQ(records[1].path.text(), "R");
    EXPECT_EQ(records[2].path.text(), "T");
    EXPECT_EQ(records[1].id, 2U);
    EXPECT_EQ(records[2].id, 3U);
    EXPECT_EQ(records[0].r, 0.125F);
    EXPECT_EQ(records[1].r, 2.0F);
    EXPECT_EQ(records[2].r, 1.0F);
}

TEST(Tree, SnellAndTotalReflection) {
    // From inside a glass block, a ray at 30 degrees is refracted by Snell's law, and one at 60 degrees is
    // totally reflected, with the transmission added.
    for (const double degrees : {30.0, 60.0}) {
        SceneBuilder b;
        const double a = degrees * std::numbers::pi / 180;
        Material m = glass(1.5, 0.8);
        m.reflection = dvec3(0.1);
        b.add(Plane{{0, 0, -2}, {0, std::sin(a), -std::cos(a)}},
              m);  // the normal points away from the camera, which is inside of the glass
        b.scene.background = dvec3(1);
        const auto records = trace_at(b.scene, centre);
        if (degrees < 41) {
            ASSERT_EQ(records.size(), 3U);
            EXPECT_NEAR(records[2].r, 0.8, 1e-6);
        } else {
            ASSERT_EQ(records.size(), 2U);
            EXPECT_EQ(records[1].path.text(), "R");
            EXPECT_NEAR(records[1].r, 0.9, 1e-6);
        }
    }
}

TEST(Tree, DepthAndContributionEndIt) {
    SceneBuilder b;
    b.add(square({0, 0, -4}, {0, 0, 1}, 20), mirror(0.5));
    b.add(square({0, 0, 4}, {0, 0, -1}, 20), mirror(0.5));
    b.scene.background = dvec3(1);
    for (int depth = 1; depth <= 6; ++depth) {
        EXPECT_EQ(trace_at(b.scene, centre, {.max_depth = depth, .min_contribution = 0}).size(),
                  static_cast<std::size_t>(depth));
    }
    // With radiance 1 in the scene, a node after k bounces has throughput 0.5^k, and its subtree a radiance
    // of 1 + 0.5 + ... A subtree that contributes less than 0.1 is not traced.
    const auto pruned = trace_at(b.scene, centre, {.max_depth = 17, .min_contribution = 0.1});
    EXPECT_EQ(pruned.size(), 5U);  // 0.5^4 * 2 > 0.1 > 0.5^5 * 2
    EXPECT_EQ(trace_at(b.scene, centre, {.max_depth = 17, .min_contribution = 0}).size(), 17U);
}

TEST(RadianceBounds, LightsThatFallOffAreBoundedByTheirDistanceFromSurfaces) {
    SceneBuilder b;
    b.add(Plane{{0, -2, 0}, {0, 1, 0}}, matte(dvec3(0.5)));
    b.add(std::make_shared<const Mesh>(Mesh{{{-9, 0, -5}, {9, 0, -5}, {0, 9, -5}}, {{0, 1, 2}}, {}, {}, {}}),
          matte(dvec3(0.5)));
    b.point_light({0, 1, 0}, dvec3(36)).attenuation = {0, 0, 1};
    // The light is 3 m above the plane and 5 m in front of the triangle.
    EXPECT_NEAR(radiance_bounds(b.scene, 1)[1], 0.5 * 36 / 9, 1e-12);
    // A ball of radius 0.5 m moves past at a distance of 2 m.
    Object& ball = b.add(Sphere{{0, 0, 0}, 0.5}, matte(dvec3(0.5)));
    ball.keys = {{.time_s = 0, .translation = {-4, 1, 2}}, {.time_s = 1, .translation = {4, 1, 2}}};
    const double reach = 0.5 * std::sqrt(3.0);  // half diagonal of the ball's bounding box
    EXPECT_NEAR(radiance_bounds(b.scene, 1)[1], 0.5 * 36 / ((2 - reach) * (2 - reach)), 1e-12);
    // A box around the light may touch it.
    b.add(Box{{-1, 0, -1}, {1, 2, 1}}, matte(dvec3(0.5)));
    EXPECT_GT(radiance_bounds(b.scene, 1)[1], 1e90);
}

TEST(RadianceBounds, IncludeWhatIsReflectedAndTransmittedAtGrazingAngles) {
    SceneBuilder b;
    b.scene.background = dvec3(1);
    Material m;
    m.fresnel = true;
    m.reflection_grazing = dvec3(0.5);
    m.transmission_grazing = dvec3(0.25);
    b.add(Sphere{{0, 0, 0}, 1}, m);
    const std::vector<double> bounds = radiance_bounds(b.scene, 2);
    EXPECT_GE(bounds[2], (1 + 0.5 + 0.25) * bounds[1]);
}

TEST(Tree, WhatIsHitNowhereIsARecordToo) {
    SceneBuilder b;
    b.scene.background = dvec3(0.25, 0.5, 0.75);
    const auto records = trace_at(b.scene, centre);
    ASSERT_EQ(records.size(), 1U);
    EXPECT_EQ(records[0].id, 0U);
    EXPECT_TRUE(std::isinf(records[0].z));
    EXPECT_EQ(records[0].w, Mat2::isotropic(0));
    EXPECT_EQ(records[0].g, 0.5F);
}

}  // namespace
}  // namespace postlens::test::tracer_test
