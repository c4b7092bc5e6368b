// Hits of rays against brute force, and rays that must not hit the surface that they leave.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <variant>
#include <vector>

#include "core/job.h"
#include "core/threads.h"
#include "tests/support/scene_builder.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/analytic_shape.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test::hits_test {
namespace {

using glm::dvec2;
using glm::dvec3;

// Nearest crossing by testing every object in double, one by one.
struct BruteHit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t object = 0;
};

// A triangle of a mesh in the space of the world, with its edges from `a` and their cross product.
struct WorldTriangle {
    dvec3 a, e1, e2, n;
};

// The triangles of each object of a scene. Shapes that are not meshes have none.
std::vector<std::vector<WorldTriangle>> world_triangles(const Scene& scene) {
    std::vector<std::vector<WorldTriangle>> out(scene.objects.size());
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&object.shape);
        if (mesh == nullptr) continue;
        for (const glm::uvec3& t : (*mesh)->triangles) {
            const auto at = [&](unsigned v) {
                return dvec3(object.world_from_object * glm::dvec4(dvec3((*mesh)->positions[v]), 1));
            };
            const dvec3 a = at(t.x), e1 = at(t.y) - a, e2 = at(t.z) - a;
            out[i].push_back({a, e1, e2, glm::cross(e1, e2)});
        }
    }
    return out;
}

BruteHit brute_force(const Scene& scene, const std::vector<std::vector<WorldTriangle>>& triangles, dvec3 o,
                     dvec3 d) {
    BruteHit best;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        const auto take = [&](double t) {
            if (t > 0 && t < best.t) best = {t, i};
        };
        if (const auto placed = place_shape(object.shape)) {
            const glm::dmat4 local = glm::inverse(object.world_from_object * placed->object_from_local);
            const auto found =
                crossings<double>(placed->shape, dvec3(local * glm::dvec4(o, 1)), glm::dmat3(local) * d);
            for (int k = 0; k < found.count; ++k) take(found.t[k]);
            continue;
        }
        for (const auto& [a, e1, e2, n] : triangles[i]) {
            const double along = glm::dot(a - o, n) / glm::dot(d, n);
            const dvec3 p = o + along * d - a;
            const double u = glm::dot(glm::cross(p, e2), n) / glm::dot(n, n),
                         v = glm::dot(glm::cross(e1, p), n) / glm::dot(n, n);
            if (u >= 0 && v >= 0 && u + v <= 1) take(along);
        }
    }
    return best;
}

SceneBuilder mixed_scene() {
    SceneBuilder b;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(-1, 1);
    const auto place = [&] {
        return glm::translate(glm::dmat4(1), dvec3(3 * u(random), 3 * u(random), -9 + 3 * u(random))) *
               glm::rotate(glm::dmat4(1), 3 * u(random),
                           glm::normalize(dvec3(u(random), u(random), u(random) + 1e-3))) *
               glm::scale(glm::dmat4(1),
                          dvec3(0.6 + 0.3 * u(random), 0.6 + 0.3 * u(random), 0.6 + 0.3 * u(random)));
    };
    const auto mesh = sphere_mesh(12, 16, true);  // shared by several: instances
    for (int i = 0; i < 6; ++i) {
        b.add(Sphere{}, matte(dvec3(1)), place());
        b.add(Sphere{{u(random), u(random), -8}, 0.4}, matte(dvec3(1)));
        b.add(Box{}, matte(dvec3(1)), place());
        b.add(Disc{{0, 0, 0}, {1, 1, 0}, 1, 0.3}, matte(dvec3(1)), place());
        b.add(square({0, 0, 0}, {0, 1, 1}, 1.5), matte(dvec3(1)), place());
        b.add(Cone{{0, 0, 0}, {0, 0.5, 1}, 0.5, 0.2, i % 2 == 0}, matte(dvec3(1)), place());
        b.add(mesh, matte(dvec3(1)), place());
    }
    b.add(Plane{{0, 0, -14}, {0.1, 0.2, 1}}, matte(dvec3(1)));
    return b;
}

TEST(Hits, PacketsFindWhatBruteForceFinds) {
    const SceneBuilder b = mixed_scene();
    const RayScene rays(b.scene, 0);
    const auto triangles = world_triangles(b.scene);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(-1, 1);
    for (const bool coherent : {true, false}) {
        RayBatch batch;
        batch.clear(false);
        std::vector<dvec3> origins, directions;
        for (int i = 0; i < 4000; ++i) {
            origins.push_back(coherent ? dvec3(0) : dvec3(4 * u(random), 4 * u(random), -9 + 4 * u(random)));
            directions.push_back(glm::normalize(coherent ? dvec3(0.5 * u(random), 0.5 * u(random), -1)
                                                         : dvec3(u(random), u(random), u(random))));
            // Embree sees floats: so does the brute force.
            origins.back() = dvec3(glm::vec3(origins.back()));
            batch.add(origins.back(), directions.back(), std::numeric_limits<float>::infinity());
        }
        rays.intersect(batch, coherent);
        int hits = 0, edges = 0;
        for (std::size_t i = 0; i < origins.size(); ++i) {
            const BruteHit expected = brute_force(b.scene, triangles, origins[i], directions[i]);
            const bool hit = batch.hit(i).valid();
            if (hit != std::isfinite(expected.t)) {
                ++edges;
                continue;
            }
            if (!hit) continue;
            const SurfacePoint s =
                rays.surface(batch.hit(i), origins[i], directions[i], static_cast<double>(batch.t[i]));
            // Within float rounding of an outline both answers are valid; all others must agree.
            if (s.object != expected.object || std::abs(s.t - expected.t) > 1e-5 * expected.t) {
                ++edges;
                continue;
            }
            ++hits;
            EXPECT_NEAR(glm::length(s.position - (origins[i] + s.t * directions[i])), 0, 1e-9);
            EXPECT_NEAR(glm::length(s.normal), 1, 1e-12);
        }
        EXPECT_GT(hits, 1000);
        EXPECT_LE(edges, 4);
    }
}

// Embree finds surfaces in an order that depends on the processor. The result for coincident surfaces must
// not depend on it.
TEST(Hits, OfSurfacesThatCoincideTheFirstIsSeen) {
    SceneBuilder b;
    const std::uint32_t count = 40;
    for (int copy = 0; copy < 2; ++copy) {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> u(-1, 1);
        for (std::uint32_t i = 0; i < count; ++i) {
            const dvec3 at(3 * u(random), 3 * u(random), -9 + u(random));
            switch (i % 4) {
                case 0:
                    b.add(Sphere{at, 0.5}, matte(dvec3(1)));
                    break;
                case 1:
                    b.add(square(at, {0.2, 0.1, 1}, 0.9), matte(dvec3(1)));
                    break;
                case 2:
                    b.add(Cone{at, {0.1, 0.8, 0.2}, 0.4, 0.2, true}, matte(dvec3(1)));
                    break;
                default:
                    b.add(Box{}, matte(dvec3(1)), glm::translate(glm::dmat4(1), at));
                    break;
            }
        }
    }
    const RayScene rays(b.scene, 0);
    for (const bool coherent : {true, false}) {
        RayBatch batch;
        batch.clear(false);
        std::vector<dvec3> directions;
        for (int i = 0; i < 10000; ++i) {
            const int column = i % 100, row = i / 100;
            directions.push_back(glm::normalize(dvec3(0.006 * (column - 50), 0.006 * (row - 50), -1)));
            batch.add(dvec3(0), directions.back(), std::numeric_limits<float>::infinity());
        }
        rays.intersect(batch, coherent);
        int hits = 0, copies = 0;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (!batch.hit(i).valid()) continue;
            const auto t = static_cast<double>(batch.t[i]);
            copies += rays.surface(batch.hit(i), dvec3(0), directions[i], t).object >= count ? 1 : 0;
            ++hits;
        }
        EXPECT_GT(hits, 2000);
        EXPECT_EQ(copies, 0) << "of " << hits;
    }
}

// A scene of all primitives lit from above, at several scales: the same points must be lit as at scale 1.
TEST(Hits, NoAcneAtAnyScale) {
    const auto lit_share = [](double scale) {
        SceneBuilder b = mixed_scene();
        const glm::dmat4 grow = glm::scale(glm::dmat4(1), dvec3(scale));
        for (Object& o : b.scene.objects) o.world_from_object = grow * o.world_from_object;
        b.point_light(scale * dvec3(2, 8, 6));
        for (Material& m : b.scene.materials) m.reflection = dvec3(0.5);
        const RayScene rays(b.scene, 0);
        const CameraModel camera(b.scene.cameras[0], 0);
        const WhittedTracer tracer(rays, camera, {.max_depth = 4, .min_contribution = 0});
        std::vector<dvec2> at;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) at.emplace_back(x + 0.31, y + 0.47);
        }
        TracedSamples traced;
        RayCounts counts;
        tracer.trace(at, traced, counts);
        std::vector<dvec3> sums;
        for (std::size_t i = 0; i < at.size(); ++i) {
            dvec3 sum(0);
            for (auto k = traced.offsets[i]; k < traced.offsets[i + 1]; ++k)
                sum += dvec3(traced.records[k].r, traced.records[k].g, traced.records[k].b);
            sums.push_back(sum);
        }
        return sums;
    };
    const auto reference = lit_share(1);
    for (const double scale : {1e-3, 1e-2, 1e3, 1e6}) {
        const auto sums = lit_share(scale);
        int wrong = 0;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            if (glm::length(sums[i] - reference[i]) > 1e-3) ++wrong;
        }
        // A few rays graze an outline or a shadow's edge, where rounding decides.
        EXPECT_LE(wrong, 6) << "of " << sums.size() << " at scale " << scale;
    }
}

// On convex objects under a light straight above the eye, every point that faces the light must be lit.
TEST(Hits, ConvexSurfacesNeverShadowThemselves) {
    for (const double scale : {1e-3, 1.0, 1e6}) {
        const std::vector<Shape> shapes{Sphere{}, Box{}, Cone{{0, 0, -0.5}, {0, 0, 0.5}, 0.5, 0.3, true},
                                        Cone{{0, 0, -0.5}, {0, 0, 0.5}, 0.5, 0.5, false},
                                        sphere_mesh(64, 128, false)};
        for (std::size_t k = 0; k < shapes.size(); ++k) {
            SceneBuilder b;
            const glm::dmat4 placed = glm::scale(glm::dmat4(1), dvec3(scale)) *
                                      glm::translate(glm::dmat4(1), dvec3(0.2, 0.1, -3)) *
                                      glm::rotate(glm::dmat4(1), 0.8, glm::normalize(dvec3(1, 0.7, 0.2)));
            b.add(shapes[k], matte(dvec3(1)), placed);
            b.point_light(scale * dvec3(1, 2, 1));
            const RayScene rays(b.scene, 0);
            const CameraModel camera(b.scene.cameras[0], 0);
            const WhittedTracer tracer(rays, camera, {});
            std::vector<dvec2> at;
            for (int y = 0; y < 48 * 4; ++y) {
                for (int x = 0; x < 64 * 4; ++x) at.emplace_back(x / 4.0, y / 4.0);
            }
            TracedSamples traced;
            RayCounts counts;
            tracer.trace(at, traced, counts);
            Scene bare = b.scene;
            bare.lights[0].casts_shadows = false;
            const RayScene bare_rays(bare, 0);
            TracedSamples unshadowed;
            WhittedTracer(bare_rays, camera, {}).trace(at, unshadowed, counts);
            int dark = 0;
            // The open cone shadows its own inside, so only its outside counts.
            for (std::size_t i = 0; i < traced.records.size(); ++i) {
                if (traced.records[i].r != unshadowed.records[i].r) ++dark;
            }
            if (k == 3) {
                EXPECT_LT(dark, static_cast<int>(counts.eye_hits));
            } else {
                EXPECT_EQ(dark, 0) << "shape " << k << " scale " << scale;
            }
        }
    }
}

TEST(Threads, TheSameBitsForAnyNumber) {
    const SceneBuilder b = mixed_scene();
    std::vector<std::vector<Record>> results;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const RayScene rays(b.scene, 0);
        const CameraModel camera(b.scene.cameras[0], 0);
        const WhittedTracer tracer(rays, camera, {});
        std::vector<TracedSamples> rows(48);
        parallel_for(rows.size(), [&](std::size_t y) {
            std::vector<dvec2> at;
            for (int x = 0; x < 64; ++x) at.emplace_back(x, y);
            RayCounts counts;
            tracer.trace(at, rows[y], counts);
        });
        std::vector<Record> all;
        for (const auto& r : rows) all.insert(all.end(), r.records.begin(), r.records.end());
        results.push_back(all);
    }
    EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace postlens::test::hits_test
