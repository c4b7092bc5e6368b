// The instants of a shutter that are recorded. The records of each instant must equal those of a trace at
// that instant alone.
#include "tracer/recording/key_instants.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <numbers>

#include "core/error.h"
#include "core/threads.h"
#include "records/motion/motion_path.h"
#include "tests/support/file_bytes.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/recording/light_keys.h"
#include "tracer/recording/recorded_motion.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/trace.h"

namespace postlens::test::key_instants_test {
namespace {

namespace fs = std::filesystem;
using glm::dvec3;

constexpr TimeSpan shutter{0, 1};

TransformKey turned(double time_s, double degrees, const dvec3& axis, const dvec3& translation = dvec3(0)) {
    return {.time_s = time_s,
            .translation = translation,
            .rotation = glm::angleAxis(degrees * std::numbers::pi / 180, glm::normalize(axis))};
}

// A box 4 m in front of the camera that rotates about its centre.
SceneBuilder turning_box(double degrees, const dvec3& axis) {
    SceneBuilder b;
    Object& box = b.add(Box{}, glowing({1, 0, 0}));
    box.keys = {turned(0, 0, axis, {0, 0, -4}), turned(1, degrees, axis, {0, 0, -4})};
    return b;
}

double sweep(const SceneBuilder& b, const TimeSpan& span = shutter) {
    return view_sweep_degrees(b.scene, b.scene.cameras[0], span);
}

// Tolerance: rounding of 512 steps in double.
constexpr double rounding_degrees = 1e-9;

TEST(ViewSweep, IsTheTurnTowardsTheCamera) {
    EXPECT_NEAR(sweep(turning_box(60, {0, 1, 0})), 60, rounding_degrees);
    EXPECT_NEAR(sweep(turning_box(60, {1, 0, 0})), 60, rounding_degrees);
    EXPECT_NEAR(sweep(turning_box(60, {0, 1, 0}), {0.25, 0.75}), 30, rounding_degrees);
    EXPECT_NEAR(sweep(turning_box(80, {0, 0, 1})), 0, rounding_degrees);
    // About an axis at 45 degrees the direction moves on a cone, by the angle times sin 45. The steps are
    // great circle arcs, which are shorter by a relative (80 / 512 degrees)^2 / 24 = 3e-7.
    EXPECT_NEAR(sweep(turning_box(80, {0, 1, 1})), 80 * std::sqrt(0.5), 80 * 3e-7);
    EXPECT_EQ(sweep(turning_box(60, {0, 1, 0}), {0.5, 0.5}), 0);
}

TEST(ViewSweep, AddsUpThereAndBack) {
    SceneBuilder b = turning_box(60, {0, 1, 0});
    b.scene.objects[0].keys.insert(b.scene.objects[0].keys.begin() + 1,
                                   turned(0.3001, 100, {0, 1, 0}, {0, 0, -4}));
    EXPECT_NEAR(sweep(b), 140, rounding_degrees);
}

TEST(ViewSweep, PassingByShowsAnotherSide) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 0.3}, glowing({1, 0, 0})).keys = {{.time_s = 0, .translation = {-4, 0, -4}},
                                                              {.time_s = 1, .translation = {4, 0, -4}}};
    EXPECT_NEAR(sweep(b), 90, rounding_degrees);
}

TEST(ViewSweep, TheCameraGoesRoundWhatStands) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -4}, 0.5}, glowing({1, 0, 0}));
    b.add(Plane{{0, -1, 0}, {0, 1, 0}}, glowing({0, 1, 0}));  // infinite, so it does not count
    Camera& camera = b.scene.cameras[0];
    // The camera moves around the ball by 45 degrees: a rotation about the ball's position.
    camera.position = {0, 0, 4};
    camera.look_at = {0, 0, 0};
    b.scene.objects[0].shape = Sphere{{0, 0, 0}, 0.5};
    camera.keys = {turned(0, 0, {0, 1, 0}), turned(1, 45, {0, 1, 0})};
    EXPECT_NEAR(sweep(b), 45, rounding_degrees);
    // Rotations about the pinhole and about the optical axis have no sweep.
    camera.position = dvec3(0);
    camera.look_at = {0, 0, -1};
    b.scene.objects[0].shape = Sphere{{0, 0, -4}, 0.5};
    EXPECT_NEAR(sweep(b), 0, rounding_degrees);
    camera.keys = {turned(0, 0, {0, 0, 1}), turned(1, 90, {0, 0, 1})};
    EXPECT_NEAR(sweep(b), 0, rounding_degrees);
    // An object that moves with the camera is always seen from the same side.
    b.scene.objects[0].keys = camera.keys = {{.time_s = 0}, {.time_s = 1, .translation = {3, 1, 2}}};
    b.scene.objects[0].motion_base = glm::dmat4(1);
    EXPECT_NEAR(sweep(b), 0, rounding_degrees);
}

TEST(ViewSweep, ARoomAroundTheCameraDoesNotTurn) {
    SceneBuilder b;
    b.add(Box{dvec3(-5), dvec3(5)}, glowing({1, 0, 0}));
    b.scene.cameras[0].keys = {{.time_s = 0}, {.time_s = 1, .translation = {2, 0, 0.5}}};
    EXPECT_EQ(sweep(b), 0);
}

TEST(ViewSweep, OrthographicCamerasSeeAlongTheAxis) {
    SceneBuilder b;
    b.scene.cameras[0].projection = Camera::Projection::orthographic;
    b.add(Sphere{{0, 0, 0}, 0.3}, glowing({1, 0, 0})).keys = {turned(0, 0, {0, 1, 0}, {-4, 0, -4}),
                                                              turned(1, 20, {0, 1, 0}, {4, 0, -4})};
    EXPECT_NEAR(sweep(b), 20, rounding_degrees);
}

LightKeys light_keys_of(const Scene& s) {
    return light_keys(s, s.cameras[0], {}, 0, shutter, 43, {});
}

TEST(LightKeys, NoneWhereNoLightChanges) {
    SceneBuilder still;
    still.add(square({0, 0, -9}, {0, 0, 1}, 100), matte(dvec3(0.8)));
    still.point_light({-1, 0, -8});
    EXPECT_EQ(light_keys_of(still.scene).keys, 1);
    // A matte wall looks the same from everywhere. Neither does a moving light change a wall that only emits.
    still.scene.cameras[0].keys = {{.time_s = 0}, {.time_s = 1, .translation = {2, 0, 0}}};
    EXPECT_EQ(light_keys_of(still.scene).keys, 1);
    still.scene.lights[0].keys = still.scene.cameras[0].keys;
    still.scene.materials[0] = glowing(dvec3(1));
    EXPECT_EQ(light_keys_of(still.scene).keys, 1);
    EXPECT_EQ(light_keys_of(turning_box(60, {0, 1, 0}).scene).keys, 1);
}

TEST(LightKeys, AMeanThatIsLinearInTimeNeedsTheEndsAlone) {
    // A directional light turns by 20 degrees, symmetrically about the normal of a wall that fills the frame.
    // The wall's radiance is the cosine: its mean over time is 0.99493, the first and the last instant have
    // 0.98481. The encoded values differ by 0.45 % of 1, 46.9 dB for a wall of diffuse 1.
    SceneBuilder b;
    b.add(square({0, 0, -9}, {0, 0, 1}, 100), matte(dvec3(1)));
    Light& sun = b.point_light({0, 0, 0});
    sun.kind = Light::Kind::directional;
    sun.direction = {0, 0, -1};
    sun.keys = {turned(0, -10, {0, 1, 0}), turned(1, 10, {0, 1, 0})};
    const LightKeys keys = light_keys_of(b.scene);
    EXPECT_EQ(keys.keys, 1);  // the first instant has the same radiance as the last
    const auto encoded = [](double v) { return 1.055 * std::pow(v, 1 / 2.4) - 0.055; };
    const double half = glm::radians(10.0);
    EXPECT_NEAR(keys.psnr_db, -20 * std::log10(encoded(std::sin(half) / half) - encoded(std::cos(half))),
                0.1);
}

TEST(LightKeys, AJumpInTheMiddleIsNotTakenForAMeanThatIsRight) {
    // A directional light turns away from a wall at once, in the middle of the shutter. The first and the
    // last instant have the right mean. With more keys, the mean is wrong by half the interval that holds the
    // jump. With 33 keys this is 1/64 of the radiance, and the encoded mean is wrong by 0.012, 38 dB.
    SceneBuilder b;
    b.add(square({0, 0, -9}, {0, 0, 1}, 100), matte(dvec3(1)));
    Light& sun = b.point_light({0, 0, 0});
    sun.kind = Light::Kind::directional;
    sun.direction = {0, 0, -1};
    sun.keys = {turned(0.5, 0, {0, 1, 0}), turned(0.500001, 120, {0, 1, 0})};
    EXPECT_EQ(light_keys_of(b.scene).keys, most_light_keys);
}

TEST(LightKeys, AreMoreWhereShadowsAndReflectionsMove) {
    SceneBuilder shadow;
    shadow.add(square({0, 0, -9}, {0, 0, 1}, 100), matte(dvec3(0.8)));
    shadow.add(Box{{-1, -1, -0.1}, {1, 1, 0.1}}, matte(dvec3(0.5))).keys = {
        {.time_s = 0, .translation = {-1, 9, 0}}, {.time_s = 1, .translation = {1, 9, 0}}};
    Light& sun = shadow.point_light({0, 0, 0});
    sun.kind = Light::Kind::directional;
    sun.direction = {0, -1, -1};  // the camera sees the shadow, but never the box
    EXPECT_GE(light_keys_of(shadow.scene).keys, 5);
    sun.casts_shadows = false;
    EXPECT_EQ(light_keys_of(shadow.scene).keys, 1);
    SceneBuilder reflection;
    reflection.add(square({0, 0, -9}, {0, 0, 1}, 100), mirror(0.9));
    reflection.add(Box{{-1, -1, 0.9}, {1, 1, 1.1}}, glowing(dvec3(1))).keys = {
        {.time_s = 0, .translation = {-1, 0, 0}}, {.time_s = 1, .translation = {1, 0, 0}}};
    const LightKeys keys = light_keys_of(reflection.scene);
    EXPECT_GE(keys.keys, 5);
    EXPECT_GE(keys.psnr_db, 43);
}

TEST(KeysForVisits, AKeyShowsWhatPassesThroughTheFrame) {
    const auto keys_of = [](std::vector<TransformKey> motion, int at_least = 1) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, -4}, 0.1}, glowing(dvec3(1))).keys = std::move(motion);
        return keys_for_visits(b.scene, b.scene.cameras[0], {}, 0, shutter, at_least);
    };
    const auto at = [](double time_s, double x) {
        return TransformKey{.time_s = time_s, .translation = {x, 0, 0}};
    };
    EXPECT_EQ(keys_of({at(0, 0), at(1, 9)}), 1);   // the frame's instant shows it
    EXPECT_EQ(keys_of({at(0, 9), at(1, 0)}), 2);   // so does the last
    EXPECT_EQ(keys_of({at(0, 9), at(1, 8)}), 1);   // out of the frame
    EXPECT_EQ(keys_of({at(0, 9), at(1, -9)}), 3);  // the middle
    EXPECT_EQ(keys_of({at(0, 9), at(1, -9)}, 4), 5);
    EXPECT_EQ(keys_of({at(0, 9), at(0.3, 9), at(0.32, 0), at(0.34, 9), at(1, 9)}), 23);  // 7 / 22 = 0.318
    // No number of keys has one at the only instant at which it is in view.
    EXPECT_EQ(keys_of({at(0, 9), at(0.318, 9), at(0.3185, 0), at(0.319, 9), at(1, 9)}), 1);
    // It passes the camera far beside the frame.
    const auto along = [](double time_s, double z) {
        return TransformKey{.time_s = time_s, .translation = {9, 0, z}};
    };
    EXPECT_EQ(keys_of({along(0, 14), along(1, -6)}), 1);
}

TEST(KeysForVisits, AKeyShowsWhatGrowsAtItsSize) {
    const auto keys_of = [](const std::vector<std::pair<double, dvec3>>& scales) {
        SceneBuilder b;
        std::vector<TransformKey>& keys = b.add(Sphere{dvec3(0), 0.1}, glowing(dvec3(1))).keys;
        for (const auto& [time_s, scale] : scales)
            keys.push_back({.time_s = time_s, .translation = {0, 0, -4}, .scale = scale});
        return keys_for_visits(b.scene, b.scene.cameras[0], {}, 0, shutter, 1);
    };
    const dvec3 one(1), small(1e-6), flat(1, 1e-3, 1);
    EXPECT_EQ(keys_of({{0, one}, {1, small}}), 1);  // the frame's instant shows it
    EXPECT_EQ(keys_of({{0, 0.6 * one}, {1, one}}), 1);
    EXPECT_EQ(keys_of({{0, small}, {1, one}}), 2);
    EXPECT_EQ(keys_of({{0, flat}, {1, one}}), 2);
    EXPECT_EQ(keys_of({{0.5, small}, {0.5001, one}}), 2);            // it appears
    EXPECT_EQ(keys_of({{0, small}, {0.5, one}, {1, small}}), 3);     // the middle
    EXPECT_EQ(keys_of({{0, small}, {0.3, one}, {0.69, small}}), 4);  // 1 / 3
}

TEST(KeysForVisits, AKeyShowsTheInsideOfWhatTheCameraPassesThrough) {
    const auto keys_of = [](const std::vector<TransformKey>& object,
                            const std::vector<TransformKey>& camera) {
        SceneBuilder b;
        b.add(Sphere{dvec3(0), 0.5}, glowing(dvec3(1))).keys = object;
        b.scene.cameras[0].keys = camera;
        return keys_for_visits(b.scene, b.scene.cameras[0], {}, 0, shutter, 1);
    };
    const auto at = [](double time_s, double z) {
        return TransformKey{.time_s = time_s, .translation = {0, 0, z}};
    };
    EXPECT_EQ(keys_of({at(0, -4)}, {at(0, 0), at(1, -3)}), 1);    // it stays outside
    EXPECT_EQ(keys_of({at(0, -4)}, {at(0, 0), at(1, -4)}), 2);    // it ends inside
    EXPECT_EQ(keys_of({at(0, -4)}, {at(0, 0), at(1, -8)}), 3);    // it is inside in the middle
    EXPECT_EQ(keys_of({at(0, -4), at(1, 4)}, {}), 3);             // the object moves instead
    EXPECT_EQ(keys_of({at(0, 0)}, {at(0, 0), at(1, 4)}), 2);      // it starts inside, and sees it from behind
    EXPECT_EQ(keys_of({at(0, 0)}, {at(0, 0), at(1, 0.4)}), 1);    // it stays inside
    EXPECT_EQ(keys_of({at(0, -0.2)}, {at(0, 0), at(1, -4)}), 1);  // it leaves forwards
}

TEST(AutomaticKeys, FollowObjectsLightAndCamera) {
    const auto keys_of = [](const Scene& s) { return automatic_keys(s, s.cameras[0], {}, 0, shutter, {}); };
    const KeyCount turns = keys_of(turning_box(60, {0, 1, 0}).scene);
    EXPECT_EQ(turns.keys, 5);
    EXPECT_EQ(turns.reason, "something turns by 60 degrees");
    SceneBuilder lamp;
    lamp.add(square({0, 0, -9}, {0, 0, 1}, 100), matte(dvec3(0.8)));
    lamp.point_light({-1, 0, -8}).keys = {{.time_s = 0}, {.time_s = 1, .translation = {2, 0, 0}}};
    const KeyCount light = keys_of(lamp.scene);
    EXPECT_GE(light.keys, 3);
    EXPECT_EQ(light.reason.rfind("light changes: ", 0), 0U) << light.reason;
    // A pan by more than half of the picture's shorter side shows what no overscan need hold.
    SceneBuilder pan;
    pan.add(square({0, 0, -9}, {0, 0, 1}, 100), glowing(dvec3(1)));
    Camera& camera = pan.scene.cameras[0];
    const double half = half_field_degrees(CameraModel(camera, 0));
    EXPECT_NEAR(std::tan(glm::radians(half)), 24 / (64 * 50 / 36.0), 1e-12);
    camera.keys = {turned(0, 0, {0, 1, 0}), turned(1, 0.99 * half, {0, 1, 0})};
    EXPECT_EQ(keys_of(pan.scene).keys, 1);
    camera.keys[1] = turned(1, 1.5 * half, {0, 1, 0});
    EXPECT_EQ(keys_of(pan.scene).keys, 3);
    EXPECT_EQ(keys_of(pan.scene).reason.rfind("the camera turns by ", 0), 0U);
    camera.keys[1] = turned(1, 90, {0, 0, 1});  // a roll
    EXPECT_EQ(keys_of(pan.scene).keys, 1);
}

TEST(KeysForSweep, OneMoreForEveryFifteenDegrees) {
    EXPECT_EQ(keys_for_sweep(0, 15), 1);
    EXPECT_EQ(keys_for_sweep(1e-9, 15), 1);
    EXPECT_EQ(keys_for_sweep(1, 15), 1);
    EXPECT_EQ(keys_for_sweep(15, 15), 1);
    EXPECT_EQ(keys_for_sweep(15.001, 15), 3);
    EXPECT_EQ(keys_for_sweep(sweep(turning_box(60, {0, 1, 0})), 15), 5);
    EXPECT_EQ(keys_for_sweep(sweep(turning_box(80, {0, 0, 1})), 15), 1);
    EXPECT_EQ(keys_for_sweep(60, 30), 3);
    EXPECT_EQ(keys_for_sweep(1e9, 15), 64);
}

TEST(KeyInstants, AreSpreadEvenlyWithBothEnds) {
    using Times = std::vector<double>;
    EXPECT_EQ(key_instants(1, shutter, 0.5), Times());
    EXPECT_EQ(key_instants(2, shutter, 0.5), (Times{0, 1}));
    EXPECT_EQ(key_instants(5, shutter, 0), (Times{0.25, 0.5, 0.75, 1}));
    EXPECT_EQ(key_instants(3, shutter, 0.5), (Times{0, 1}));
    EXPECT_EQ(key_instants(3, shutter, 1), (Times{0, 0.5}));
    EXPECT_EQ(key_instants(3, shutter, 7), (Times{0, 0.5, 1}));
    EXPECT_EQ(key_instants(64, shutter, 7).size(), 64U);
    EXPECT_EQ(key_instants(64, shutter, 7).back(), 1);
    // Instants that agree to 1e-9 are equal, such as -0.1 + 0.3 / 3 and 0.
    EXPECT_EQ(key_instants(2, {0, 1 + 1e-11}, 1), (Times{0}));
    EXPECT_EQ(key_instants(4, {-0.1, 0.2}, 0).size(), 3U);
    // A shutter of length 0 has one instant.
    EXPECT_EQ(key_instants(9, {0.5, 0.5}, 0), (Times{0.5}));
    EXPECT_EQ(key_instants(9, {0.5, 0.5}, 0.5), Times());
}

TEST(FilmMotion, MovesPointsAsTheSceneDoes) {
    // A rotating box and a camera that rotates and moves: compares a corner of the box with the formula.
    SceneBuilder b = turning_box(70, {0.3, 1, 0.2});
    Camera& camera = b.scene.cameras[0];
    camera.keys = {turned(0, 0, {0, 1, 0}), turned(1, 8, {0, 1, 0.5}, {0.3, 0.1, -0.2})};
    const double from_s = 0.2, to_s = 0.9;
    const std::vector<double> at{to_s};
    const FilmMotion film(recorded_motion(b.scene, camera), camera, {}, from_s, at);
    const MotionPath path(b.scene.objects[0].keys);
    const dvec3 corner{0.5, -0.5, 0.5};
    const CameraModel then(camera, to_s);
    const auto expected = then.place(path.at(to_s).point(corner));
    const auto got = film.place(1, path.at(from_s).point(corner), 0);
    ASSERT_TRUE(expected && got);
    // Tolerance: a few dozen roundings of raster positions.
    EXPECT_NEAR(got->x, expected->x, 1e-11 * 64);
    EXPECT_NEAR(got->y, expected->y, 1e-11 * 64);
    // `place` inverts `ray` at any distance.
    const CameraRay ray = then.ray(11.5, 40.25);
    for (const double t : {0.1, 3.0, 1e6}) {
        EXPECT_NEAR(then.place(ray.origin + t * ray.direction)->x, 11.5, 1e-11 * 64);
        EXPECT_NEAR(then.place(ray.origin + t * ray.direction)->y, 40.25, 1e-11 * 64);
    }
    EXPECT_NEAR(film.place_of_nothing(ray.direction, {}, 0)->x, 11.5, 1e-11 * 64);
    EXPECT_FALSE(then.place(ray.origin - ray.direction));
    Camera flat = camera;
    flat.projection = Camera::Projection::orthographic;
    const CameraModel parallel(flat, to_s);
    const CameraRay side = parallel.ray(11.5, 40.25);
    EXPECT_NEAR(parallel.place(side.origin + 3.0 * side.direction)->y, 40.25, 1e-11 * 64);
}

TEST(FilmMotion, KnowsWhichRaysMayMeetWhatMoves) {
    SceneBuilder b = turning_box(70, {0, 1, 0});  // its bounding ball has radius sqrt(0.75) about (0, 0, -4)
    const std::vector<double> at{0.5};
    const FilmMotion film(recorded_motion(b.scene, b.scene.cameras[0]), b.scene.cameras[0], {}, 0, at);
    const dvec3 ahead{0, 0, -1};
    EXPECT_TRUE(film.may_meet_moving({0.86, 0, 0}, ahead, 0));
    EXPECT_FALSE(film.may_meet_moving({0.87, 0, 0}, ahead, 0));
    EXPECT_TRUE(film.may_meet_moving({0, 0, 0}, ahead, 4.86));
    EXPECT_FALSE(film.may_meet_moving({0, 0, 0}, ahead, 4.87));
    EXPECT_FALSE(film.may_meet_moving({0, 0, 0}, -ahead, 0));
}

TEST(RecordedMotion, NamesIdsWhoseShapesMoveApart) {
    SceneBuilder b;
    const std::vector<TransformKey> keys{{.time_s = 0}, {.time_s = 1, .translation = {1, 0, 0}}};
    for (int i = 0; i < 6; ++i) b.add(Sphere{}, glowing({1, 0, 0}));
    const std::uint32_t ids[] = {1, 1, 2, 2, 3, 3};
    for (std::size_t i = 0; i < 6; ++i) b.scene.objects[i].id = ids[i];
    b.scene.objects[0].keys = b.scene.objects[1].keys = b.scene.objects[3].keys = keys;
    EXPECT_EQ(ids_that_move_apart(b.scene), std::vector<std::uint32_t>{2});
    b.scene.objects[4].keys = b.scene.objects[5].keys = keys;
    b.scene.objects[5].keys[1].translation.x = 2;
    EXPECT_EQ(ids_that_move_apart(b.scene), (std::vector<std::uint32_t>{2, 3}));
}

// Files -------------------------------------------------------------------------------------------------

// A scene with shadows, mirrors, a ball that moves before and behind other objects, and a panning camera.
SceneBuilder moving_scene() {
    SceneBuilder b;
    Material shiny = mirror(0.4);
    shiny.diffuse = dvec3(0.3);
    b.add(square({0, 0, -6}, {0, 0, 1}, 8), matte({0.2, 0.7, 0.3}));
    b.add(Box{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}, shiny).keys = {turned(0, 0, {0, 1, 0}, {-0.7, 0, -4}),
                                                                   turned(1, 40, {0, 1, 0.2}, {0.3, 0, -4})};
    b.add(sphere_mesh(6, 8, true), matte({0.8, 0.3, 0.1})).keys = {
        turned(0, 0, {1, 0, 0}, {1, 0.2, -5}), turned(1, 30, {1, 0, 0}, {0.2, 0.4, -4.8})};
    b.add(Box{{-0.05, -2, -2.1}, {0.05, 2, -2}}, matte(dvec3(0.5)));
    b.point_light({2, 3, 0});
    b.scene.cameras[0].keys = {turned(0, 0, {0, 1, 0}), turned(1, 2, {0, 1, 0})};
    return b;
}

TraceSettings trace_settings(int keys) {
    TraceSettings s;
    s.for_shutter = shutter;
    s.keys = keys;
    s.overscan_px = 1;
    return s;
}

TEST(KeyFiles, HoldAtEachInstantWhatATraceThereRecords) {
    const TemporaryFolder folder;
    const SceneBuilder b = moving_scene();
    const fs::path path = folder.path() / "a.exr", alone_path = folder.path() / "b.exr";
    // Five keys are among the nine instants at which motion is always sampled.
    for (const bool automatic : {true, false}) {
        TraceSettings settings = trace_settings(5);
        settings.time_s = 0.5;
        if (!automatic) settings.hidden_layers = 2;
        const TraceResult result = trace_to_file(b.scene, settings, path);
        EXPECT_EQ(result.instants_s, (std::vector<double>{0.5, 0, 0.25, 0.75, 1}));
        const SampleFileReader file(path);
        ASSERT_EQ(file.instants(), 5U);
        EXPECT_EQ(file.header().sufficient.shutter_close_s, 1.0);
        EXPECT_EQ(file.record_count(), result.records);
        RayCounts rays;
        for (std::size_t i = 0; i < 5; ++i) {
            settings.keys = 1;
            settings.time_s = result.instants_s[i];
            rays += trace_to_file(b.scene, settings, alone_path).rays;
            const SampleFileReader alone(alone_path);
            ASSERT_EQ(alone.instants(), 1U);
            RecordBand expected, got;
            alone.read(alone.y_begin(), alone.y_end(), expected);
            file.read(file.y_begin(), file.y_end(), got, i);
            EXPECT_EQ(file.instant_s(i), settings.time_s);
            EXPECT_EQ(got.offsets, expected.offsets);
            EXPECT_TRUE(got.records == expected.records) << i;
            const auto hidden = std::count_if(got.records.begin(), got.records.end(),
                                              [](const Record& r) { return r.layer > 0; });
            EXPECT_GT(hidden, 50) << i;
        }
        EXPECT_EQ(rays.eye, result.rays.eye);
        EXPECT_EQ(rays.hidden, result.rays.hidden);
        EXPECT_EQ(rays.shadow, result.rays.shadow);
    }
}

TEST(KeyFiles, SameBitsForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    const SceneBuilder b = moving_scene();
    std::string first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        trace_to_file(b.scene, trace_settings(3), folder.path() / "a.exr");
        const std::string bytes = bytes_of(folder.path() / "a.exr");
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << threads;
    }
}

TEST(KeyFiles, ThePictureIsTheFramesOwn) {
    const TemporaryFolder folder;
    const SceneBuilder b = moving_scene();
    TraceSettings bare, keyed = trace_settings(3);
    bare.overscan_px = 1;
    bare.subdivision.levels = keyed.subdivision.levels = 0;  // edges of hidden surfaces would add samples
    trace_to_file(b.scene, bare, folder.path() / "a.exr");
    trace_to_file(b.scene, keyed, folder.path() / "b.exr");
    const SampleFileReader one(folder.path() / "a.exr"), more(folder.path() / "b.exr");
    EXPECT_EQ(one.picture().rgb, more.picture().rgb);
    EXPECT_FALSE(one.header().has_layers);
    EXPECT_TRUE(more.header().has_layers);
}

TEST(KeyFiles, AutomaticKeysFollowTheMotion) {
    const TemporaryFolder folder;
    TraceSettings settings = trace_settings(1);
    settings.keys.reset();
    TraceResult r = trace_to_file(turning_box(60, {0, 1, 0}).scene, settings, folder.path() / "a.exr");
    EXPECT_EQ(r.keys, 5);
    EXPECT_NEAR(r.keys_sweep_degrees.value(), 60, rounding_degrees);
    EXPECT_EQ(r.instants_s.size(), 5U);
    r = trace_to_file(turning_box(60, {0, 0, 1}).scene, settings, folder.path() / "a.exr");
    EXPECT_EQ(r.keys, 1);
    EXPECT_EQ(r.instants_s.size(), 1U);
}

TEST(Overscan, ReachesAsFarAsTheShutterBringsThingsIn) {
    const TemporaryFolder folder;
    // The scale is 64 px * 50 / 36 mm = 88.9 px per unit of tangent, so 1 m at a distance of 4 m is 22.2 px.
    // A ball of radius 0.6 m moves by 1 m to the right. The part of it outside of the left border, at least 1
    // m, moves into the frame.
    SceneBuilder b;
    b.add(square({0, 0, -9}, {0, 0, 1}, 100), glowing({0, 1, 0}));
    const auto overscan = [&](const std::vector<TransformKey>& keys,
                              const std::vector<TransformKey>& camera) {
        SceneBuilder c = b;
        c.add(Sphere{{0, 0, 0}, 0.6}, glowing({1, 1, 0})).keys = keys;
        c.scene.cameras[0].keys = camera;
        TraceSettings settings = trace_settings(1);
        settings.overscan_px = 0;
        settings.overscan_auto = true;
        const TraceResult r = trace_to_file(c.scene, settings, folder.path() / "a.exr");
        EXPECT_EQ(SampleFileReader(folder.path() / "a.exr").header().overscan_px, r.overscan_px);
        return r.overscan_px;
    };
    const double edge = -32 / (64 * 50 / 36.0) * 4;              // the frame's left edge at 4 m
    EXPECT_EQ(overscan({{.time_s = 0}, {.time_s = 1}}, {}), 0);  // the ball is not in view and does not move
    const int right = overscan({{.time_s = 0, .translation = {edge - 0.4, 0, -4}},
                                {.time_s = 1, .translation = {edge + 0.6, 0, -4}}},
                               {});
    // The coarse samples are 8 px apart.
    EXPECT_GE(right, 22);
    EXPECT_LE(right, 22 + 16);
    // A ball that moves out of the frame, or along its border, needs no overscan.
    EXPECT_EQ(overscan({{.time_s = 0, .translation = {edge, 0, -4}},
                        {.time_s = 1, .translation = {edge - 2, 0, -4}}},
                       {}),
              0);
    // The border cuts off 4 px of a ball, which end between two of the coarse samples.
    EXPECT_GE(overscan({{.time_s = 0, .translation = {edge + 0.6 - 4 / 22.2, 0, -4}},
                        {.time_s = 1, .translation = {edge + 1.6, 0, -4}}},
                       {}),
              4);
    // A ball that is hidden by a nearer still object counts as well.
    b.add(Box{{-2, -1, -3.1}, {-1.1, 1, -3}}, glowing({1, 0, 0}));
    EXPECT_GE(overscan({{.time_s = 0, .translation = {edge - 0.4, 0, -4}},
                        {.time_s = 1, .translation = {edge + 0.6, 0, -4}}},
                       {}),
              22);
    // A pan by 5 degrees moves the image by 88.9 * tan 5 degrees = 7.8 px on the axis, and by more at the
    // sides (tan 24.8 - tan 19.8 degrees: 9.1 px).
    const int pan =
        overscan({{.time_s = 0}, {.time_s = 1}}, {turned(0, 0, {0, 1, 0}), turned(1, 5, {0, 1, 0})});
    EXPECT_GE(pan, 9);
    EXPECT_LE(pan, 9 + 16);
}

TEST(Overscan, LetsEveryKeyHoldWhatItsNeighboursNeed) {
    // A plate of 40 px comes in from the left by 160 px, from beyond all overscan at the frame's instant.
    // Half of the plate is outside of the frame at the third of four keys, at 2/3 s.
    SceneBuilder b;
    const double px = 4 / (64 * 50 / 36.0);
    b.add(square({0, 0, -4}, {0, 0, 1}, 40 * px), glowing(dvec3(1))).keys = {
        {.time_s = 0, .translation = {(-32 - 160 * 2 / 3.0) * px, 0, 0}},
        {.time_s = 1, .translation = {(-32 + 160 / 3.0) * px, 0, 0}}};
    const TemporaryFolder folder;
    TraceSettings settings = trace_settings(4);
    settings.overscan_px = 0;
    settings.overscan_auto = true;
    const int overscan = trace_to_file(b.scene, settings, folder.path() / "a.exr").overscan_px;
    EXPECT_GE(overscan, 20);
    EXPECT_LE(overscan, 32);  // half of the frame, the most
    settings.keys = 1;
    EXPECT_EQ(trace_to_file(b.scene, settings, folder.path() / "a.exr").overscan_px, 0);
}

TEST(TraceSettingsOfShutters, AreChecked) {
    const TemporaryFolder folder;
    const SceneBuilder b = moving_scene();
    const auto refused = [&](const TraceSettings& settings, const char* part) {
        try {
            trace_to_file(b.scene, settings, folder.path() / "a.exr");
            ADD_FAILURE() << "accepted: " << part;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::wrong_arguments) << part;
            EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
        }
    };
    const double nan = std::nan("");
    for (const int keys : {0, 65, -1}) refused(trace_settings(keys), "--keys: out of range");
    for (const int layers : {-1, 17}) {
        TraceSettings s = trace_settings(1);
        s.hidden_layers = layers;
        refused(s, "--hidden-layers: out of range");
    }
    for (const TimeSpan span : {TimeSpan{1, 0}, TimeSpan{nan, 1}, TimeSpan{0, nan}, TimeSpan{0, INFINITY}}) {
        TraceSettings s = trace_settings(1);
        s.for_shutter = span;
        refused(s, "--for-shutter: ");
    }
    TraceSettings s;
    s.keys = 2;
    refused(s, "--keys: needs");
    s.keys.reset();
    refused(s, "--keys: needs");
    s.keys = 1;
    s.hidden_auto = true;
    refused(s, "--hidden-layers auto: needs");
    s.hidden_auto = false;
    s.overscan_auto = true;
    refused(s, "--overscan auto: needs");
    EXPECT_EQ(folder.file_count(), 0U);
}

}  // namespace
}  // namespace postlens::test::key_instants_test
