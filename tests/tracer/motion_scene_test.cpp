// Scenes over a time span: a ray at an instant has the same hit as in the still scene of that instant.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tests/tracer/moving_shapes.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens::test::motion_scene_test {
namespace {

using glm::dvec3;

struct Counts {
    int rays = 0, hits = 0, other = 0;
};

// Analytic shapes follow their exact motion in double. Differences are roundings of 2^-53 times the condition
// of the transforms (below 100 for scales down to 0.7) and of hits near a silhouette, where the root of the
// discriminant may be as small as 1e-3.
void compare_exact(const SurfacePoint& a, const SurfacePoint& b, const std::string& what) {
    constexpr double tolerance = 1e-9;
    EXPECT_NEAR(a.t, b.t, tolerance * b.t) << what;
    EXPECT_LE(glm::length(a.position - b.position), tolerance * b.t) << what;
    EXPECT_LE(glm::length(a.geometric_normal - b.geometric_normal), tolerance) << what;
    EXPECT_LE(glm::length(a.normal - b.normal), tolerance) << what;
    EXPECT_LE(glm::length(a.object_position - b.object_position), tolerance * b.t) << what;
    EXPECT_LE(glm::length(a.uv - b.uv), 1e-8) << what;  // angles about a nearby axis amplify rounding
}

// Meshes move linearly between steps, with an error of at most motion_m (plus 1/8 between the instants that
// motion_steps tests). Along the ray this is motion_m / |d . n|; in object space it is larger by 1 / 0.7, the
// smallest scale. The error of a normal is the change of the linear part, 2 motion_m over the smallest half
// width, plus the curvature of about 1 / 0.7 radians per metre; uvs behave like positions. Embree's float
// transforms add 1e-6.
void compare_mesh(const SurfacePoint& a, const SurfacePoint& b, const dvec3& d, const std::string& what) {
    const double along = 1.125 * motion_m / std::abs(glm::dot(d, b.geometric_normal)) + 2e-6;
    EXPECT_NEAR(a.t, b.t, along) << what;
    EXPECT_LE(glm::length(a.position - b.position), along) << what;
    const double own = (along + 1.125 * motion_m) / 0.7;
    EXPECT_LE(glm::length(a.geometric_normal - b.geometric_normal), 6 * motion_m) << what;
    EXPECT_LE(glm::length(a.normal - b.normal), 6 * motion_m + 4 * own) << what;
    EXPECT_LE(glm::length(a.object_position - b.object_position), 2 * own) << what;
    EXPECT_LE(glm::length(a.uv - b.uv), 4 * own) << what;
}

Counts compare_hits(const NamedShape& shape, const MotionKind& kind, std::uint64_t seed) {
    RandomNumbers random(seed);
    const SceneBuilder b = scene_of(shape, kind, random);
    const RayScene moving(b.scene, shutter, accuracy());
    EXPECT_TRUE(moving.moves());
    EXPECT_LE(moving.motion_error_px(), 0.05);
    Counts counts;
    const std::vector<double> times = times_of(kind, random, 5);
    Rays r = rays_at(b.scene, times, 96, random);
    RayBatch at_once = r.batch;
    moving.intersect(r.batch, false);
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double time = times[k];
        const RayScene still(b.scene, shutter.at(time));
        still.intersect(at_once, false);
        for (std::size_t i = k; i < r.o.size(); i += times.size()) {
            ++counts.rays;
            const std::string what =
                std::string(shape.name) + ", " + kind.name + ", at " + std::to_string(time);
            if (!r.batch.hit(i).valid() || !at_once.hit(i).valid()) {
                ADD_FAILURE() << what << ": a ray leaves the ball around everything";
                continue;
            }
            const SurfacePoint p =
                moving.surface(r.batch.hit(i), r.o[i], r.d[i], static_cast<double>(r.batch.t[i]), time);
            const SurfacePoint q =
                still.surface(at_once.hit(i), r.o[i], r.d[i], static_cast<double>(at_once.t[i]));
            // Embree's own t of the same hit is a float, with an error of 2^-20 of the distance divided by
            // the cosine of incidence.
            const double cosine = std::abs(glm::dot(r.d[i], p.geometric_normal));
            EXPECT_NEAR(static_cast<double>(r.batch.t[i]), p.t, 1e-5 * p.t / std::max(cosine, 0.05)) << what;
            const bool other = p.object != q.object || (!shape.mesh && p.part != q.part) ||
                               (shape.mesh && r.batch.hit(i).primitive != at_once.hit(i).primitive);
            if (other) {
                ++counts.other;
                continue;
            }
            if (q.object + 1 == b.scene.objects.size()) continue;
            ++counts.hits;
            if (shape.mesh) {
                if (cosine > 0.05) compare_mesh(p, q, r.d[i], what);
            } else {
                compare_exact(p, q, what);
            }
        }
    }
    return counts;
}

TEST(MovingScene, HitsWhatTheSceneOfTheInstantHas) {
    std::uint64_t seed = 100;
    for (const NamedShape& shape : all_shapes()) {
        for (const MotionKind& kind : kinds) {
            const Counts c = compare_hits(shape, kind, seed++);
            EXPECT_GT(c.hits, c.rays / 6) << shape.name;
            // For analytic shapes, only rays within float rounding of an outline or edge may differ: one in
            // 10^5. For meshes, rays within motion_m of a triangle's edge may differ. Their edges have a
            // length per area below 20 per m, which makes 0.4 %, and more at grazing incidence.
            EXPECT_LE(c.other, shape.mesh ? c.rays / 50 : 1) << shape.name << ", " << kind.name;
        }
    }
}

// A mesh has one Embree instance per interval between keys. At the instant of a key both instances exist at
// the same position, but light must be filtered as by one.
TEST(MovingScene, AtAKeyAMeshIsThereOnce) {
    for (const double key : {0.5, 0.3137}) {
        SceneBuilder b;
        Material m = matte(dvec3(1));
        m.transmission = dvec3(0.5);
        Object& o = b.add(sphere_mesh(6, 8, false), m);
        o.keys.resize(3);
        o.keys[1].time_s = key;
        o.keys[1].translation = dvec3(0.5, 0, 0);
        o.keys[2].time_s = 1;
        o.keys[2].translation = dvec3(0.5, 1, 0);
        const RayScene moving(b.scene, {0, 1}, accuracy());
        const auto at = static_cast<float>(key);
        for (const float time : {std::nextafter(at, 0.0F), at, std::nextafter(at, 1.0F)}) {
            RayBatch r;
            r.clear(false, true);
            // The rays avoid edges between triangles, where one or both triangles may be crossed.
            for (int i = 0; i < 16; ++i) r.add({0.453 + 0.01 * i, 0.0171, 5}, {0, 0, -1}, 100.0F, {}, time);
            moving.occlude(r);
            for (std::size_t i = 0; i < 16; ++i)
                EXPECT_NEAR(r.transmittance[i].x, 0.25, 1e-9) << "key " << key << ", time " << time;
            moving.intersect(r, true);
            for (std::size_t i = 0; i < 16; ++i) EXPECT_TRUE(r.hit(i).valid());
        }
    }
}

// A bar whose motion has a kink, hit by packets of rays with different times, some close to the key. Rays of
// one interval must not hit the instance of the other, although they share a packet.
TEST(MovingScene, RaysOfAPacketEachHaveTheirOwnTime) {
    for (const double key : {0.25, 0.5, 0.3137, 0.9}) {
        SceneBuilder b;
        auto bar = std::make_shared<Mesh>();
        bar->positions = {{0, 8, -20}, {0.15, 8, -20}, {0.15, 8, 20}, {0, 8, 20}};
        bar->triangles = {{0, 1, 2}, {0, 2, 3}};
        Object& o = b.add(std::shared_ptr<const Mesh>(bar), matte(dvec3(1)));
        o.keys.resize(3);
        o.keys[1].time_s = key;
        o.keys[1].translation.x = 1;
        o.keys[2].time_s = 1;
        o.keys[2].translation.x = 2;
        const RayScene moving(b.scene, {0, 1}, accuracy());
        RandomNumbers random(60);
        RayBatch r;
        r.clear(false, true);
        std::vector<double> places;
        for (int i = 0; i < 1 << 14; ++i) {
            const double time = i % 4 == 0 ? random.in(key - 0.05, key + 0.05) : random.in(0, 1);
            places.push_back(i % 16 == 0 ? random.in(0, 2.1) : places.back() + 0.01);
            r.add({places.back(), 0.1, 0.1}, {0, 1, 0}, 100.0F, {}, static_cast<float>(time));
        }
        RayBatch eye = r, bounced = r;
        moving.occlude(r);
        moving.intersect(eye, true);
        moving.intersect(bounced, false);
        int inside = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double x = transform_at(b.scene.objects[0].keys, static_cast<double>(r.time[i]))[3].x;
            const double into = std::min(places[i] - x, x + 0.15 - places[i]);
            if (std::abs(into) < 1e-5) continue;  // within float rounding of the bar's border
            inside += into > 0 ? 1 : 0;
            EXPECT_EQ(r.transmittance[i].x, into > 0 ? 0 : 1) << "key " << key << ", time " << r.time[i];
            EXPECT_EQ(eye.hit(i).valid(), into > 0) << "key " << key << ", time " << r.time[i];
            EXPECT_EQ(bounced.hit(i).valid(), into > 0) << "key " << key << ", time " << r.time[i];
        }
        EXPECT_GT(inside, 500);
    }
}

TEST(MovingScene, WhatDoesNotMoveWithinTheSpanIsAsStill) {
    for (const NamedShape& shape : all_shapes()) {
        RandomNumbers random(41);
        SceneBuilder b = scene_of(shape, kinds[1], random);
        for (Object& o : b.scene.objects) {
            if (o.keys.empty()) continue;
            const TransformKey pose = o.keys[0];
            TransformKey before = pose, after = pose;
            before.translation += dvec3(3);
            after.translation -= dvec3(3);
            o.keys = {before, pose, pose, after};
            const double times[] = {-1, shutter.open_s, shutter.close_s, 3};
            for (std::size_t i = 0; i < 4; ++i) o.keys[i].time_s = times[i];
        }
        const RayScene moving(b.scene, shutter, accuracy()), still(b.scene, shutter.open_s);
        EXPECT_FALSE(moving.moves()) << shape.name;
        EXPECT_EQ(moving.motion_error_px(), 0);
        Rays r = rays_at(b.scene, {0.0, 0.4, 1.0}, 64, random);
        RayBatch at_once = r.batch;
        moving.intersect(r.batch, false);
        still.intersect(at_once, false);
        for (std::size_t i = 0; i < r.o.size(); ++i) {
            EXPECT_EQ(r.batch.hit(i), at_once.hit(i)) << shape.name;
            EXPECT_EQ(r.batch.t[i], at_once.t[i]) << shape.name;
        }
    }
}

// A motion that is too fast for the greatest number of steps is reported.
TEST(MovingScene, TooFastForEmbreeIsSaid) {
    SceneBuilder b;
    Object& o = b.add(sphere_mesh(4, 6, false), matte(dvec3(1)));
    o.keys.resize(2);
    o.keys[1].time_s = 1;
    o.keys[1].rotation = glm::angleAxis(3.0, dvec3(0, 0, 1));
    const MotionAccuracy strict{[](const dvec3&, double) { return 1e6; }, 0.05};
    const RayScene scene(b.scene, {0, 1}, strict);
    // A circle of radius 1 by chords of 3 / 128 radians has an error of their height, 1 - cos(3 / 256). The
    // corners of the ball's box are farther out by a factor of sqrt(2).
    const double height = 1 - std::cos(3.0 / 256);
    EXPECT_GE(scene.motion_error_px(), 0.99e6 * height);
    EXPECT_LE(scene.motion_error_px(), 1.01e6 * std::sqrt(2.0) * height);
}

}  // namespace
}  // namespace postlens::test::motion_scene_test
