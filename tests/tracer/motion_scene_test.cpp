// Scenes over a time span: a ray at an instant must have the same hit as in the still scene of that instant.
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "scene/shape_bounds.h"
#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/shading.h"

namespace postlens::test {
namespace {

using glm::dmat4;
using glm::dvec3;

constexpr TimeSpan shutter{0.25, 1.25};
// Time of a key inside the shutter interval, at a fraction that neither floats nor equal steps hit exactly.
constexpr double kink_s = 0.25 + 0.3137;

std::shared_ptr<const Mesh> smooth_ball(int rings, int sectors) {
    auto mesh = std::make_shared<Mesh>(*sphere_mesh(rings, sectors, true));
    for (const glm::vec3& p : mesh->positions) mesh->uvs.emplace_back(p.x, p.y * p.z);
    return mesh;
}

struct NamedShape {
    const char* name;
    Shape shape;
    bool mesh = false, twice = false;
};

// All kinds of shapes. With "twice", two objects share the mesh, which is large enough to be shared in
// Embree.
std::vector<NamedShape> all_shapes() {
    return {{"sphere", Sphere{{0.1, 0, 0}, 0.8}},
            {"box", Box{{-0.8, -0.4, -0.3}, {0.9, 0.5, 0.4}}},
            {"disc", Disc{{0, 0, 0}, {0, 1, 2}, 1, 0.3}},
            {"rectangle", Rectangle{{-1, -0.5, 0}, {2, 0, 0}, {0, 1, 0.2}}},
            {"plane", Plane{{0, 0, 0}, {0.2, 0.1, 1}}},
            {"cone", Cone{{0, 0, -0.8}, {0, 0.1, 0.9}, 0.7, 0.2, true}},
            {"cylinder", Cone{{0, -0.9, 0}, {0, 0.9, 0}, 0.4, 0.4, false}},
            {"flat mesh", sphere_mesh(6, 8, false), true},
            {"smooth mesh", smooth_ball(6, 8), true},
            {"shared mesh", smooth_ball(12, 16), true, true}};
}

// A textured material, because uvs and object positions are only computed for textured objects.
Material textured() {
    Material m = matte(dvec3(1));
    m.colour_texture = std::make_shared<Texture>(Checker{});
    return m;
}

struct MotionKind {
    const char* name;
    bool uniform;       // the scale is uniform and constant
    std::size_t count;  // keys
};
constexpr MotionKind kinds[] = {{"rigid, two keys", true, 2},
                                {"stretched, two keys", false, 2},
                                {"rigid, a kink", true, 3},
                                {"stretched, a kink", false, 3}};

std::vector<TransformKey> keys_of(const MotionKind& kind, RandomNumbers& random) {
    RandomKeys options{0.8, 1.2, 0.7, 1.4};
    if (kind.uniform) options.scale_low = options.scale_high = 1;
    std::vector<double> times{0.1, 1.6};
    if (kind.count == 3) times = {0.1, kink_s, 1.6};
    return random_keys(random, times, options);
}

SceneBuilder scene_of(const NamedShape& shape, const MotionKind& kind, RandomNumbers& random) {
    SceneBuilder b;
    const Material m = textured();
    Object& o = b.add(shape.shape, m);
    o.keys = keys_of(kind, random);
    o.motion_base = glm::translate(dmat4(1), random.in_box(0.2));
    if (shape.twice) {
        Object& second = b.add(shape.shape, m);
        second.keys = keys_of(kind, random);
        for (TransformKey& k : second.keys) k.translation += dvec3(2.5, 0, 0);
    }
    b.add(Sphere{{0, 0, 0}, 40}, matte(dvec3(1)));  // a still background
    return b;
}

// Tolerance of a mesh's motion, m.
constexpr double motion_m = 1e-4;
MotionAccuracy accuracy() {
    return {[](const dvec3&, double) { return 0.05 / motion_m; }, 0.05};
}

struct Rays {
    RayBatch batch;
    std::vector<dvec3> o, d;

    void add(const dvec3& from, const dvec3& to, double time) {
        // Origins and directions are rounded to float, so that both scenes get the same ray in double.
        const dvec3 start(glm::vec3{from}), direction(glm::vec3(glm::normalize(to - start)));
        o.push_back(start);
        d.push_back(glm::normalize(direction));
        batch.add(start, direction, std::numeric_limits<float>::infinity(), {}, static_cast<float>(time));
    }
};

// Rays from around the object towards its position at their time; some miss it. Ray i has time
// times[i % times.size()], so that a packet has rays of many times.
Rays rays_at(const Scene& scene, const std::vector<double>& times, int per_time, RandomNumbers& random) {
    Rays r;
    r.batch.clear(false, true);
    for (int i = 0; i < per_time; ++i) {
        for (const double time : times) {
            const Object& o = scene.objects[scene.objects.size() > 2 ? static_cast<std::size_t>(i % 2) : 0];
            const dvec3 middle(transform_at(o.keys, shutter.at(time)) * o.motion_base *
                               glm::dvec4(0, 0, 0, 1));
            const dvec3 from = middle + 5.0 * random.direction();
            r.add(from, middle + random.in_box(0.8), time);
        }
    }
    return r;
}

std::vector<double> times_of(const MotionKind& kind, RandomNumbers& random, int count) {
    std::vector<double> times{0, 1, 0.5};
    if (kind.count == 3) {
        const auto key = static_cast<float>((kink_s - shutter.open_s) / (shutter.close_s - shutter.open_s));
        for (const float t : {std::nextafter(key, 0.0F), key, std::nextafter(key, 1.0F)})
            times.push_back(static_cast<double>(t));
    }
    for (int i = 0; i < count; ++i) times.push_back(static_cast<double>(static_cast<float>(random.in(0, 1))));
    return times;
}

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

TEST(MovingScene, ShadowsAreThoseOfTheInstant) {
    std::uint64_t seed = 300;
    for (NamedShape shape : all_shapes()) {
        for (const MotionKind& kind : {kinds[1], kinds[3]}) {
            for (const bool glassy : {false, true}) {
                RandomNumbers random(seed++);
                SceneBuilder b = scene_of(shape, kind, random);
                b.scene.objects.pop_back();  // removes the background
                if (glassy) {
                    for (Material& m : b.scene.materials) m.transmission = dvec3(0.5, 0.7, 0.9);
                }
                const RayScene moving(b.scene, shutter, accuracy());
                int rays = 0, dark = 0, other = 0;
                const std::vector<double> times = times_of(kind, random, 6);
                Rays r = rays_at(b.scene, times, 64, random);
                for (std::size_t i = 0; i < r.o.size(); ++i) r.batch.t_far[i] = i % 3 == 0 ? 4.5F : 9;
                RayBatch at_once = r.batch;
                moving.occlude(r.batch);
                for (std::size_t k = 0; k < times.size(); ++k) {
                    const RayScene still(b.scene, shutter.at(times[k]));
                    still.occlude(at_once);
                    for (std::size_t i = k; i < r.o.size(); i += times.size()) {
                        ++rays;
                        dark += at_once.transmittance[i].x < 1 ? 1 : 0;
                        other += r.batch.transmittance[i] == at_once.transmittance[i] ? 0 : 1;
                    }
                }
                EXPECT_GT(dark, rays / 8) << shape.name;
                // As for hits, only rays may differ that pass an outline, or end, within rounding or
                // motion_m.
                EXPECT_LE(other, shape.mesh ? rays / 50 : 1)
                    << shape.name << ", " << kind.name << (glassy ? ", glass" : "");
            }
        }
    }
}

// For many glass objects with long motions, Embree splits time and may meet the same object in several
// intervals. Each crossing must filter light only once.
TEST(MovingScene, LightPassesEachOfACrowdOnce) {
    for (const int what : {0, 1, 2}) {
        RandomNumbers random(70);
        SceneBuilder b;
        Material m = matte(dvec3(1));
        m.transmission = dvec3(0.5);
        for (int i = 0; i < 60; ++i) {
            Shape shape = Sphere{{0, 0, 0}, 0.5};
            if (what == 1) shape = Box{{-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3}};
            if (what == 2) shape = sphere_mesh(6, 8, false);
            b.add(shape, m).keys = random_keys(random, {0.1, 0.6, 1.6}, {5, 0.5, 1, 1});
        }
        const RayScene moving(b.scene, shutter, accuracy());
        const std::vector<double> times = times_of(kinds[1], random, 9);
        Rays r;
        r.batch.clear(false, true);
        for (int i = 0; i < 64; ++i) {
            const dvec3 from = 20.0 * random.direction(), to = random.in_box(3);
            for (const double time : times) r.add(from, to + random.in_box(0.1), time);
        }
        std::fill(r.batch.t_far.begin(), r.batch.t_far.end(), 100.0F);
        RayBatch at_once = r.batch;
        moving.occlude(r.batch);
        int coloured = 0, other = 0;
        for (std::size_t k = 0; k < times.size(); ++k) {
            const RayScene still(b.scene, shutter.at(times[k]));
            still.occlude(at_once);
            for (std::size_t i = k; i < r.o.size(); i += times.size()) {
                coloured += at_once.transmittance[i].x < 1 ? 1 : 0;
                other += r.batch.transmittance[i] == at_once.transmittance[i] ? 0 : 1;
            }
        }
        EXPECT_GT(coloured, 100) << what;
        EXPECT_LE(other, what == 2 ? static_cast<int>(r.o.size()) / 50 : 1) << what;
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

// On a convex object, no point that faces the light lies in the object's own shadow.
TEST(MovingScene, NothingShadowsItself) {
    std::uint64_t seed = 500;
    for (const NamedShape& shape : all_shapes()) {
        for (const MotionKind& kind : kinds) {
            RandomNumbers random(seed++);
            SceneBuilder b = scene_of(shape, kind, random);
            // Two objects that share a mesh would cast shadows on each other.
            if (shape.twice) b.scene.objects.erase(b.scene.objects.begin() + 1);
            b.point_light({9, 7, 8}).casts_shadows = true;
            const RayScene moving(b.scene, shutter, accuracy());
            const PlacedLight light = place_light(b.scene.lights[0], 0.0);
            int lit_points = 0;
            Rays r = rays_at(b.scene, times_of(kind, random, 6), 96, random);
            moving.intersect(r.batch, false);
            RayBatch shadows;
            shadows.clear(true, true);
            for (std::size_t i = 0; i < r.o.size(); ++i) {
                const HitKey key = r.batch.hit(i);
                const auto time = static_cast<double>(r.batch.time[i]);
                const SurfacePoint p =
                    moving.surface(key, r.o[i], r.d[i], static_cast<double>(r.batch.t[i]), time);
                if (p.object != 0) continue;
                const Facing f = face(p, r.d[i]);
                // Tests only the outer side, because the inner side of a closed shape is dark.
                const bool flat = std::holds_alternative<Disc>(shape.shape) ||
                                  std::holds_alternative<Rectangle>(shape.shape) ||
                                  std::holds_alternative<Plane>(shape.shape);
                if (!flat && f.sign < 0) continue;
                const Lit lit = lit_by(light, light.position, p, f, b.scene.materials[0], dvec3(1), r.d[i]);
                // Beyond the horizon of the geometric surface, a smooth normal may still face the light.
                if (lit.radiance == dvec3(0) || glm::dot(f.geometric_normal, lit.to_light) < 0.01) continue;
                shadows.add(lit.origin, lit.segment, lit.reach, key, r.batch.time[i]);
            }
            moving.occlude(shadows);
            for (std::size_t i = 0; i < static_cast<std::size_t>(shadows.count); ++i) {
                ++lit_points;
                EXPECT_EQ(shadows.transmittance[i], dvec3(1))
                    << shape.name << ", " << kind.name << ", at " << shadows.time[i];
            }
            EXPECT_GT(lit_points, 100) << shape.name << ", " << kind.name;
        }
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
}  // namespace postlens::test
