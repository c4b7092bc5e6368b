// Scenes over a time span: what a ray at an instant hits is what the scene of that instant has there.
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "tests/random_motion.h"
#include "tests/scene_builder.h"
#include "tracer/ray_scene.h"
#include "tracer/shading.h"
#include "tracer/shape_bounds.h"

namespace postlens::test {
namespace {

using glm::dmat4;
using glm::dvec3;

constexpr TimeSpan shutter{0.25, 1.25};
// A key inside the shutter's time at no share that a float or equal steps would meet.
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

// Every kind of shape; "twice": two objects share the mesh, which is large enough to be shared by Embree too.
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

// uvs and positions in the object's own space are made for what has a texture only.
Material textured() {
    Material m = matte(dvec3(1));
    m.colour_texture = std::make_shared<Texture>(Checker{});
    return m;
}

struct MotionKind {
    const char* name;
    bool uniform;       // one scale for all axes, no change of it
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
    b.add(Sphere{{0, 0, 0}, 40}, matte(dvec3(1)));  // what lies behind, still
    return b;
}

// What an error of a mesh's motion may be, m.
constexpr double motion_m = 1e-4;
MotionAccuracy accuracy() {
    return {[](const dvec3&, double) { return 0.05 / motion_m; }, 0.05};
}

struct Rays {
    RayBatch batch;
    std::vector<dvec3> o, d;

    void add(const dvec3& from, const dvec3& to, double time) {
        // Origins as floats, so that both scenes are asked for the same ray in double too.
        const dvec3 start(glm::vec3{from}), direction(glm::vec3(glm::normalize(to - start)));
        o.push_back(start);
        d.push_back(glm::normalize(direction));
        batch.add(start, direction, std::numeric_limits<float>::infinity(), {}, static_cast<float>(time));
    }
};

// Rays from around the object at its time towards it, some past it: ray i at times[i % times.size()], so that
// rays of many times share a packet.
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

// Analytic shapes go by their true motion, in double as in the scene of that instant: what differs are
// roundings of 2^-53 times the condition of the transforms (scales down to 0.7: below 100), and of a hit near
// a silhouette, whose root of the discriminant may be as small as 1e-3 in some thousand rays.
void compare_exact(const SurfacePoint& a, const SurfacePoint& b, const std::string& what) {
    constexpr double tolerance = 1e-9;
    EXPECT_NEAR(a.t, b.t, tolerance * b.t) << what;
    EXPECT_LE(glm::length(a.position - b.position), tolerance * b.t) << what;
    EXPECT_LE(glm::length(a.geometric_normal - b.geometric_normal), tolerance) << what;
    EXPECT_LE(glm::length(a.normal - b.normal), tolerance) << what;
    EXPECT_LE(glm::length(a.object_position - b.object_position), tolerance * b.t) << what;
    EXPECT_LE(glm::length(a.uv - b.uv), 1e-8) << what;  // angles about an axis that is near
}

// Meshes go linearly from step to step and stray by motion_m at most (and the 1/8 that lies between the
// places that motion_steps looks at). Along the ray that is motion_m / |d . n|; in the object's own space it
// grows by 1 / 0.7, its smallest scale; a normal errs by the change of the linear part, 2 motion_m over the
// object's smallest half width, and by the surface's own turn, some 1 / 0.7 radians per metre, with uvs like
// positions. Floats of Embree's transforms add 1e-6.
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
            // Embree's own t, in float, of the same surface: 2^-20 of what the ray travelled, divided by the
            // cosine at which it meets it.
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
            // Analytic: only rays within a float's rounding of an outline or an edge, one in 10^5, may
            // differ. Meshes: those within motion_m of an edge of their triangles, whose length per area is
            // below 20 per m for these: 0.4 %; at grazing incidence more.
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
                b.scene.objects.pop_back();  // the ball around everything
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
                // As for hits: only rays that pass an outline (or, t_far, end) within rounding or motion_m.
                EXPECT_LE(other, shape.mesh ? rays / 50 : 1)
                    << shape.name << ", " << kind.name << (glassy ? ", glass" : "");
            }
        }
    }
}

// Many glass things on long ways: Embree cuts time up for them, and meets the same one in several stretches
// of it. Light must be coloured once per crossing.
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

// Between two keys a mesh is one instance for Embree, and the next stretch has another: at the key's very
// instant both are there, in the same place. Light must pass them as if there were one.
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
            // Beside the edges: where two triangles meet, either or both may be crossed.
            for (int i = 0; i < 16; ++i) r.add({0.453 + 0.01 * i, 0.0171, 5}, {0, 0, -1}, 100.0F, {}, time);
            moving.occlude(r);
            for (std::size_t i = 0; i < 16; ++i)
                EXPECT_NEAR(r.transmittance[i].x, 0.25, 1e-9) << "key " << key << ", time " << time;
            moving.intersect(r, true);
            for (std::size_t i = 0; i < 16; ++i) EXPECT_TRUE(r.hit(i).valid());
        }
    }
}

// A bar whose motion has a kink, met by packets of rays each of its own time, some close to the key: an
// instance of one stretch is not there for a ray of the other, though both are in one packet.
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
            if (std::abs(into) < 1e-5) continue;  // within float's rounding of its border
            inside += into > 0 ? 1 : 0;
            EXPECT_EQ(r.transmittance[i].x, into > 0 ? 0 : 1) << "key " << key << ", time " << r.time[i];
            EXPECT_EQ(eye.hit(i).valid(), into > 0) << "key " << key << ", time " << r.time[i];
            EXPECT_EQ(bounced.hit(i).valid(), into > 0) << "key " << key << ", time " << r.time[i];
        }
        EXPECT_GT(inside, 500);
    }
}

// Convex and lit from where its normals point: no point of it lies in its own shadow.
TEST(MovingScene, NothingShadowsItself) {
    std::uint64_t seed = 500;
    for (const NamedShape& shape : all_shapes()) {
        for (const MotionKind& kind : kinds) {
            RandomNumbers random(seed++);
            SceneBuilder b = scene_of(shape, kind, random);
            // Both of a pair that shares its mesh would throw shadows on each other.
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
                // Only the outer side, as the inner one of a closed shape is dark.
                const bool flat = std::holds_alternative<Disc>(shape.shape) ||
                                  std::holds_alternative<Rectangle>(shape.shape) ||
                                  std::holds_alternative<Plane>(shape.shape);
                if (!flat && f.sign < 0) continue;
                const Lit lit = lit_by(light, light.position, p, f, b.scene.materials[0], dvec3(1), r.d[i]);
                // Past the horizon of the true surface a smooth normal may still see the light.
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

// Faster than the most steps can follow: said, not hidden.
TEST(MovingScene, TooFastForEmbreeIsSaid) {
    SceneBuilder b;
    Object& o = b.add(sphere_mesh(4, 6, false), matte(dvec3(1)));
    o.keys.resize(2);
    o.keys[1].time_s = 1;
    o.keys[1].rotation = glm::angleAxis(3.0, dvec3(0, 0, 1));
    const MotionAccuracy strict{[](const dvec3&, double) { return 1e6; }, 0.05};
    const RayScene scene(b.scene, {0, 1}, strict);
    // A circle of radius 1 by chords of 3 / 128 radians strays by their height, 1 - cos(3 / 256); the corners
    // of the ball's box lie a root of 2 further out.
    const double height = 1 - std::cos(3.0 / 256);
    EXPECT_GE(scene.motion_error_px(), 0.99e6 * height);
    EXPECT_LE(scene.motion_error_px(), 1.01e6 * std::sqrt(2.0) * height);
}

}  // namespace
}  // namespace postlens::test
