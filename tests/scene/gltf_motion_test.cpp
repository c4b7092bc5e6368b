// glTF: positions, motion, cameras, lights and units.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

#include "scene/placement.h"
#include "scene/sampled_motion.h"
#include "scene/scene.h"
#include "tests/scene/gltf_text.h"
#include "tests/scene/mesh_text.h"
#include "tracer/camera_model.h"

namespace postlens::test::gltf_motion_test {
namespace {

using glm::dmat4;
using glm::dvec3;

TEST_F(MeshText, ANodesPlaceIsTheProductOfThoseAboveIt) {
    GltfText g;
    g.nodes =
        R"({"children":[1],"translation":[1,2,3],"rotation":[0,0,0.70710678118654752,0.70710678118654752],"scale":[2,2,2]},)"
        R"({"children":[2],"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]},{"mesh":0,"scale":[1,1,-1]})";
    const Scene s = read(g);
    ASSERT_EQ(s.objects.size(), 1U);
    // (1,0,0) is scaled along z, rotated by 90 degrees to (0,1,0), translated by (5,0,0), scaled by 2 to
    // (10,2,0), rotated by 90 degrees to (-2,10,0) and translated by (1,2,3).
    EXPECT_LT(glm::length(moved(s.objects[0], 0, {1, 0, 0}) - dvec3(-1, 12, 3)), 1e-14);
    EXPECT_LT(glm::length(moved(s.objects[0], 0, {0, 0, 1}) - dvec3(1, 12, 1)), 1e-14);
}

TEST_F(MeshText, MotionOfOneAboveAnotherIsTheirProduct) {
    // From the root: a still node with scale 2, a node that moves along x and rotates about z, a translated
    // node, and the node of the mesh, which rotates about y.
    const auto h = static_cast<float>(std::sqrt(0.5));
    GltfText g;
    g.nodes =
        R"({"children":[1],"scale":[2,2,2]},{"children":[2]},{"children":[3],"translation":[1,0,0]},{"mesh":0})";
    g.animate(1, "translation", "LINEAR", {0, 2}, {0, 0, 0, 4, 0, 0});
    g.animate(1, "rotation", "LINEAR", {0, 2}, {0, 0, 0, 1, 0, 0, h, h});
    g.animate(3, "rotation", "LINEAR", {0.5F, 1.5F}, {0, 0, 0, 1, 0, h, 0, h});
    const Scene s = read(g);
    ASSERT_EQ(s.objects.size(), 1U);
    const double size = 2 * std::sqrt(2.0);  // diagonal of the triangle's box, times the scale 2
    double worst = 0;
    for (int i = 0; i <= 300; ++i) {
        const double t = 2.0 * i / 300, quarter = std::numbers::pi / 2;
        const double about_z = quarter * t / 2, about_y = quarter * std::clamp(t - 0.5, 0.0, 1.0);
        for (const dvec3& p : {dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0)}) {
            const dvec3 turned = glm::angleAxis(about_y, dvec3(0, 1, 0)) * p + dvec3(1, 0, 0);
            const dvec3 wanted =
                2.0 * (glm::angleAxis(about_z, dvec3(0, 0, 1)) * turned + dvec3(2 * t, 0, 0));
            worst = std::max(worst, glm::length(moved(s.objects[0], t, p) - wanted));
        }
    }
    EXPECT_LT(worst, 1e-4 * size / 0.93);
    EXPECT_GT(worst, 0);
}

TEST_F(MeshText, LinearMotionOfOneNodeNeedsItsKeysOnly) {
    GltfText g;
    g.nodes = R"({"children":[1],"translation":[0,0,7],"rotation":[1,0,0,0],"scale":[3,3,3]},{"mesh":0})";
    g.animate(1, "translation", "LINEAR", {1, 2, 4}, {0, 0, 0, 1, 0, 0, 1, 5, 0});
    g.animate(1, "scale", "LINEAR", {1, 4}, {1, 1, 1, 4, 1, 1});
    const Scene s = read(g);
    const auto& keys = s.objects.at(0).keys;
    ASSERT_EQ(keys.size(), 3U);
    EXPECT_EQ(keys[0].time_s, 1);
    EXPECT_EQ(keys[2].time_s, 4);
    EXPECT_LT(glm::length(keys[1].scale - dvec3(6, 3, 3)), 1e-14);
    EXPECT_LT(glm::length(moved(s.objects[0], 0, {0, 0, 0}) - dvec3(0, 0, 7)),
              1e-14);  // clamped before its first
    EXPECT_LT(glm::length(moved(s.objects[0], 3, {0, 0, 0}) - dvec3(3, -7.5, 7)), 1e-13);
}

TEST_F(MeshText, StepsJumpAtTheirKeys) {
    GltfText g;
    g.animate(0, "translation", "STEP", {0, 1, 2}, {0, 0, 0, 5, 0, 0, 9, 0, 0});
    const Object o = read(g).objects.at(0);
    EXPECT_EQ(moved(o, 0.999, dvec3(0)).x, 0);
    EXPECT_EQ(moved(o, 1 - 2 * shortest_key_gap_s, dvec3(0)).x, 0);
    EXPECT_EQ(moved(o, 1, dvec3(0)).x, 5);
    EXPECT_EQ(moved(o, 1.5, dvec3(0)).x, 5);
    EXPECT_EQ(moved(o, 3, dvec3(0)).x, 9);
    EXPECT_EQ(o.keys.size(), 5U);
}

TEST_F(MeshText, AConstantCurveIsNoMotion) {
    GltfText g;
    g.animate(0, "translation", "LINEAR", {0, 1}, {3, 0, 0, 3, 0, 0});
    const Object o = read(g).objects.at(0);
    EXPECT_TRUE(o.keys.empty());
    EXPECT_EQ(o.world_from_object[3].x, 3);
}

TEST_F(MeshText, ACubicRotationIsNormalised) {
    GltfText g;
    // With tangents of 0, q(t) is the normalised blend by 3 t^2 - 2 t^3 of the identity and a rotation by 120
    // degrees about z.
    const double half = std::numbers::pi / 3;
    const auto z = static_cast<float>(std::sin(half)), w = static_cast<float>(std::cos(half));
    g.animate(0, "rotation", "CUBICSPLINE", {0, 1},
              {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, z, w, 0, 0, 0, 0});
    const Object o = read(g).objects.at(0);
    double worst = 0;
    for (int i = 0; i <= 100; ++i) {
        const double t = i / 100.0, b = 3 * t * t - 2 * t * t * t;
        const double angle = 2 * std::atan2(b * static_cast<double>(z), 1 - b + b * static_cast<double>(w));
        worst =
            std::max(worst, glm::length(moved(o, t, {1, 0, 0}) - dvec3(std::cos(angle), std::sin(angle), 0)));
    }
    EXPECT_LT(worst, 1e-4 * std::sqrt(2.0) / 0.93);
}

TEST(Placement, TakesMatricesApart) {
    const Placement p{{1, 2, 3}, glm::angleAxis(2.0, glm::normalize(dvec3(1, -2, 0.5))), {-2, 0.5, 3}};
    const Decomposed d = decompose(matrix_of(p));
    EXPECT_LT(d.error, 1e-14);
    const dmat4 back = matrix_of(d.placement), wanted = matrix_of(p);
    for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(back[c] - wanted[c]), 1e-13);
    dmat4 sheared(1);
    sheared[1].x = 0.5;
    EXPECT_GT(decompose(sheared).error, 0.1);
    dmat4 flat(1);
    flat[2] = glm::dvec4(0);
    EXPECT_EQ(decompose(flat).placement.scale, dvec3(1, 1, 0));
}

TEST_F(MeshText, CamerasAndLightsMoveWithTheirNodes) {
    GltfText g;
    g.nodes =
        R"({"mesh":0},{"children":[2],"scale":[3,3,3]},{"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}})";
    g.roots = "0,1";
    g.more =
        R"("cameras":[{"type":"perspective","perspective":{"yfov":0.5}}],)"
        R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":3.14159265358979,"color":[1,0.5,0],"range":9}]}},)";
    const auto h = static_cast<float>(std::sqrt(0.5));
    g.animate(2, "translation", "LINEAR", {0, 1}, {0, 0, 1, 0, 0, 2});
    g.animate(2, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, h, 0, h});
    const Scene s = read(g, {.lumens_per_watt = 1});
    ASSERT_EQ(s.cameras.size(), 1U);
    ASSERT_EQ(s.lights.size(), 1U);
    for (const double t : {0.0, 0.5, 1.0}) {
        const CameraModel model(s.cameras[0], t);
        const double angle = std::numbers::pi / 2 * t;
        EXPECT_LT(glm::length(model.position - dvec3(0, 0, 3 + 3 * t)), 1e-3);
        EXPECT_LT(glm::length(model.forward - dvec3(-std::sin(angle), 0, -std::cos(angle))), 1e-3);
        for (const TransformKey& k : s.cameras[0].keys) EXPECT_EQ(k.scale, dvec3(1));
    }
    const Light& l = s.lights[0];
    EXPECT_LT(glm::length(l.intensity - dvec3(1, 0.5, 0)), 1e-12);
    EXPECT_EQ(l.attenuation, dvec3(0, 0, 1));
    EXPECT_NEAR(l.cone_degrees, 90, 1e-9);
    EXPECT_EQ(l.cone_soft_degrees, 0);
    EXPECT_EQ(l.keys, s.cameras[0].keys);
    EXPECT_TRUE(notes_have(s, "range of a light"));
    EXPECT_EQ(s.ambient_light, dvec3(0));
}

// Compares the radiance of a diffuse floor of albedo 0.8 with Cycles (measured to 0.1 %), for lights exported
// by Blender.
TEST_F(MeshText, LightsAreDividedByLumensPerWatt) {
    const auto light = [&](const std::string& type, double intensity, const SceneReadOptions& options) {
        GltfText g;
        g.nodes = R"({"mesh":0},{"extensions":{"KHR_lights_punctual":{"light":0}}})";
        g.roots = "0,1";
        g.more = fmt::format(
            R"("extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"{}","intensity":{}}}]}}}},)", type,
            intensity);
        const Scene s = read(g, options);
        EXPECT_EQ(s.lumens_per_watt, options.lumens_per_watt);
        return s.lights.at(0).intensity.x;
    };
    // A sun of 2 W/m^2 at 30 degrees, and a point light of 1000 W at 3 m above the floor.
    const double candela = 1000 / (4 * std::numbers::pi) * 683;
    EXPECT_NEAR(0.8 * light("directional", 2 * 683, {}) * std::cos(std::numbers::pi / 6), 0.441063, 1e-6);
    EXPECT_NEAR(0.8 * light("point", candela, {}) / 9, 2.251581, 1e-6);
    EXPECT_NEAR(0.8 * light("spot", candela, {}) / 9, 2.251581, 1e-6);
    EXPECT_NEAR(light("point", std::numbers::pi, {.lumens_per_watt = 1}), 1, 1e-15);
    EXPECT_NEAR(light("point", std::numbers::pi, {.lumens_per_watt = 4}), 0.25, 1e-15);
    GltfText dark;
    EXPECT_FALSE(read(dark).lumens_per_watt);
}

TEST_F(MeshText, LengthsFollowTheUnit) {
    GltfText g;
    g.nodes =
        R"({"mesh":0,"translation":[10,0,0]},{"translation":[0,5,0],"extensions":{"KHR_lights_punctual":{"light":0}}})";
    g.roots = "0,1";
    g.more = R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},)";
    g.animate(0, "translation", "LINEAR", {0, 1}, {10, 0, 0, 20, 0, 0});
    const Scene s = read(g, {.metres_per_unit = 0.01});
    EXPECT_LT(glm::length(moved(s.objects.at(0), 1, {0.01, 0, 0}) - dvec3(0.21, 0, 0)), 1e-8);
    EXPECT_EQ(s.lights.at(0).position, dvec3(0, 0.05, 0));
    // The light at 5 units of the file is the same as at 5 m.
    EXPECT_NEAR(s.lights[0].attenuation.z * 0.05 * 0.05, 25, 1e-12);
}

}  // namespace
}  // namespace postlens::test::gltf_motion_test
