// Scenes over a time span: shadows and light are those of the instant of a ray.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tests/tracer/moving_shapes.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/shading.h"

namespace postlens::test::moving_shadows_test {
namespace {

using glm::dvec3;

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

}  // namespace
}  // namespace postlens::test::moving_shadows_test
