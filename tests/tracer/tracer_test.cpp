// Whitted shading against closed forms, hits against brute force, and rays that must not hit the surface that
// they leave.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "core/error.h"
#include "core/threads.h"
#include "tests/support/scene_builder.h"
#include "tracer/intersection/analytic_shape.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/radiance_bounds.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test {
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

// Nearest crossing by testing every object in double, one by one.
struct BruteHit {
    double t = std::numeric_limits<double>::infinity();
    std::uint32_t object = 0;
};
BruteHit brute_force(const Scene& scene, dvec3 o, dvec3 d) {
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
        const auto& mesh = *std::get<std::shared_ptr<const Mesh>>(object.shape);
        for (const glm::uvec3& t : mesh.triangles) {
            const auto at = [&](unsigned v) {
                return dvec3(object.world_from_object * glm::dvec4(dvec3(mesh.positions[v]), 1));
            };
            const dvec3 a = at(t.x), e1 = at(t.y) - a, e2 = at(t.z) - a, n = glm::cross(e1, e2);
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
            const BruteHit expected = brute_force(b.scene, origins[i], directions[i]);
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
            directions.push_back(glm::normalize(dvec3(0.006 * (i % 100 - 50), 0.006 * (i / 100 - 50), -1)));
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

TEST(Camera, RaysGoThroughTheFilm) {
    Camera c;
    c.focal_length_mm = 50;
    c.width = 960;
    c.height = 540;
    const CameraModel m(c, 0);
    EXPECT_NEAR(m.pixel_pitch_mm, 36.0 / 960, 1e-15);
    const CameraRay corner = m.ray(960, 0);
    EXPECT_NEAR(corner.direction.x / -corner.direction.z, 18.0 / 50, 1e-12);
    EXPECT_NEAR(corner.direction.y / -corner.direction.z, 10.125 / 50, 1e-12);
    EXPECT_NEAR(corner.cos_axis, -corner.direction.z, 1e-15);

    c.focal_length_mm.reset();
    c.vertical_fov_degrees = 45;
    c.fov_between_pixel_centres = true;
    c.width = c.height = 512;
    const CameraModel nff(c, 0);
    const CameraRay first_row = nff.ray(256, 0.5);
    EXPECT_NEAR(std::atan2(first_row.direction.y, -first_row.direction.z) * 180 / std::numbers::pi, 22.5,
                1e-9);

    c.projection = Camera::Projection::orthographic;
    c.orthographic_width_m = 4;
    const CameraModel ortho(c, 0);
    EXPECT_NEAR(ortho.ray(0, 256).origin.x, -2, 1e-12);
    EXPECT_EQ(ortho.ray(0, 256).direction, glm::dvec3(0, 0, -1));
}

TEST(Camera, RefusesWhatIsNoView) {
    Camera c;
    c.look_at = c.position;
    EXPECT_THROW(CameraModel(c, 0), Error);
    Camera parallel;
    parallel.up = {0, 0, 1};
    EXPECT_THROW(CameraModel(parallel, 0), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.width = 0}), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.width = 1 << 20}), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.film_distance_mm = -1}), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.film_width_mm = std::nan("")}), Error);
}

TEST(Threads, TheSameBitsForAnyNumber) {
    const SceneBuilder b = mixed_scene();
    std::vector<std::vector<Record>> results;
    for (const int threads : {1, 2, 5}) {
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
    EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace postlens::test
