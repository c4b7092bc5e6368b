// W and z' against exact rays: for a displaced lens point, Newton's method finds the ray through all mirrors
// and glass that reaches the same point.
#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "tests/support/scene_builder.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test::refocus_test {
namespace {

using glm::dvec2;
using glm::dvec3;
using Bounce = NodePath::Bounce;

struct ChainEnd {
    bool reached = false;
    dvec3 point{0}, direction{0};
    double length = 0;
};

// Follows a path in double, by plain laws of reflection and refraction.
ChainEnd follow(const RayScene& rays, dvec3 o, dvec3 d, NodePath path) {
    ChainEnd end;
    HitKey from;
    dvec3 off(0);  // offset of Embree's float ray from neighbouring facets; the exact ray has none
    for (int i = 0;; ++i) {
        RayBatch batch;
        batch.clear(true);
        batch.add(o + off, d, std::numeric_limits<float>::infinity(), from);
        rays.intersect(batch, false);
        const bool last = i == path.depth();
        if (!batch.hit(0).valid()) {
            end.reached = last;
            end.direction = d;
            return end;
        }
        from = batch.hit(0);
        const SurfacePoint s = rays.surface(from, o, d, static_cast<double>(batch.t[0]));
        end.length += s.t;
        end.point = s.position;
        end.direction = d;
        end.reached = last;
        if (last) return end;
        dvec3 n = s.normal;
        const bool entering = glm::dot(n, d) < 0;
        if (!entering) n = -n;
        const double ior = rays.scene().materials[rays.scene().objects[s.object].material].ior;
        o = s.position;
        if (path.bounce(i) == Bounce::reflected) {
            d = glm::normalize(glm::reflect(d, n));
        } else {
            d = glm::refract(d, n, entering ? 1 / ior : ior);
            if (d == dvec3(0)) return {};
            d = glm::normalize(d);
        }
        off = RayScene::offset(o) * (glm::dot(d, s.geometric_normal) > 0 ? 1.0 : -1.0) * s.geometric_normal;
    }
}

// Follows the eye ray with tangent p through lens point q, both along the raster's axes.
ChainEnd from_lens(const RayScene& rays, const CameraModel& c, dvec2 p, dvec2 q, NodePath path) {
    const dvec3 o = c.position + q.x * c.right + q.y * c.down;
    return follow(rays, o, glm::normalize(c.forward + p.x * c.right + p.y * c.down), path);
}

// The target that is kept constant, as two coordinates perpendicular to `axis`: the hit point, or the
// direction of a ray that leaves the scene.
dvec2 held(const ChainEnd& e, bool at_infinity, const dvec3& axis) {
    const dvec3 hint = std::abs(axis.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 a = glm::normalize(glm::cross(axis, hint)), b = glm::cross(axis, a);
    const dvec3 v = at_infinity ? e.direction : e.point;
    return {glm::dot(v, a), glm::dot(v, b)};
}

// W column by column: -dp/dq with constant target, by Newton's method and central differences.
glm::dmat2 exact_w(const RayScene& rays, const CameraModel& c, dvec2 p0, NodePath path, bool at_infinity) {
    const ChainEnd base = from_lens(rays, c, p0, dvec2(0), path);
    const dvec3 axis = glm::normalize(base.direction);
    const dvec2 target = held(base, at_infinity, axis);
    const auto at = [&](dvec2 p, dvec2 q) { return held(from_lens(rays, c, p, q, path), at_infinity, axis); };
    const auto solve = [&](dvec2 q) {
        dvec2 p = p0;
        for (int i = 0; i < 30; ++i) {
            const dvec2 error = at(p, q) - target;
            if (glm::length(error) < 1e-14) break;
            constexpr double h = 1e-6;
            const dvec2 jx = (at(p + dvec2(h, 0), q) - at(p - dvec2(h, 0), q)) / (2 * h);
            const dvec2 jy = (at(p + dvec2(0, h), q) - at(p - dvec2(0, h), q)) / (2 * h);
            p -= glm::inverse(glm::dmat2(jx, jy)) * error;
        }
        return p;
    };
    constexpr double h = 2e-5;
    return {-(solve({h, 0}) - solve({-h, 0})) / (2 * h), -(solve({0, h}) - solve({0, -h})) / (2 * h)};
}

struct Case {
    std::string name;
    SceneBuilder builder;
    NodePath path;
    std::vector<dvec2> at;  // raster positions
    bool at_infinity = false;
};

NodePath chain(const std::string& letters) {
    NodePath p;
    for (const char c : letters) p = p.child(c == 'R' ? Bounce::reflected : Bounce::transmitted);
    return p;
}

void check(Case& c) {
    const RayScene rays(c.builder.scene, 0);
    const CameraModel camera(c.builder.scene.cameras[0], 0);
    const WhittedTracer tracer(rays, camera, {.max_depth = 12, .min_contribution = 0});
    for (const dvec2 at : c.at) {
        TracedSamples traced;
        RayCounts counts;
        tracer.trace(std::vector<dvec2>{at}, traced, counts);
        const Record* node = nullptr;
        for (const Record& r : traced.records) {
            if (r.path == c.path) node = &r;
        }
        ASSERT_NE(node, nullptr) << c.name << " at " << at.x << "," << at.y;
        const CameraRay eye = camera.ray(at.x, at.y);
        const dvec2 p{(at.x - camera.width / 2.0) * camera.pixel_pitch_mm / camera.film_distance_mm,
                      (at.y - camera.height / 2.0) * camera.pixel_pitch_mm / camera.film_distance_mm};
        const ChainEnd end = from_lens(rays, camera, p, dvec2(0), c.path);
        ASSERT_TRUE(end.reached) << c.name;
        if (c.at_infinity) {
            EXPECT_TRUE(std::isinf(node->z)) << c.name;
        } else {
            EXPECT_NEAR(node->z, end.length * eye.cos_axis, 1e-6 * end.length) << c.name;
        }
        const glm::dmat2 w = exact_w(rays, camera, p, c.path, c.at_infinity);
        const double scale =
            std::max({std::abs(w[0][0]), std::abs(w[0][1]), std::abs(w[1][0]), std::abs(w[1][1]), 1e-3});
        const std::string where = c.name + " at " + std::to_string(at.x) + "," + std::to_string(at.y);
        EXPECT_NEAR(node->w.xx, w[0][0], 1e-3 * scale) << where;
        EXPECT_NEAR(node->w.yx, w[0][1], 1e-3 * scale) << where;
        EXPECT_NEAR(node->w.xy, w[1][0], 1e-3 * scale) << where;
        EXPECT_NEAR(node->w.yy, w[1][1], 1e-3 * scale) << where;
    }
}

const std::vector<dvec2> spread{{32, 24}, {30.25, 25.5}, {35, 20}, {28, 29}};

TEST(RefocusMatrix, FlatMirrorIsTheUnfoldedDistance) {
    Case c{"flat mirror", {}, chain("R"), spread};
    c.builder.add(square({0, 0, -2}, {0, 0, 1}, 3), mirror());
    c.builder.add(square({0, 0, 1}, {0.3, 0.1, -1}, 9), glowing(dvec3(1)));
    check(c);
    const RayScene rays(c.builder.scene, 0);
    const CameraModel camera(c.builder.scene.cameras[0], 0);
    TracedSamples traced;
    RayCounts counts;
    WhittedTracer(rays, camera, {}).trace(std::vector<dvec2>{{32, 24}}, traced, counts);
    EXPECT_NEAR(traced.records[1].z, 5, 1e-5);
    EXPECT_NEAR(traced.records[1].w.xx, 1 / 5.0, 1e-6);
    EXPECT_NEAR(traced.records[1].w.xy, 0, 1e-6);
}

TEST(RefocusMatrix, Mirror45DegreesTwoPlusThreeMakesFive) {
    Case c{"45 degree mirror", {}, chain("R"), spread};
    c.builder.add(square({0, 0, -2}, {1, 0, 1}, 4), mirror());
    c.builder.add(square({3, 0, -2}, {-1, 0, 0}, 9), glowing(dvec3(1)));
    check(c);
    const RayScene rays(c.builder.scene, 0);
    const CameraModel camera(c.builder.scene.cameras[0], 0);
    TracedSamples traced;
    RayCounts counts;
    WhittedTracer(rays, camera, {}).trace(std::vector<dvec2>{{32, 24}}, traced, counts);
    EXPECT_NEAR(traced.records[1].z, 5, 1e-5);
}

TEST(RefocusMatrix, ConvexSphereMirror) {
    Case c{"convex sphere mirror", {}, chain("R"), spread};
    c.builder.add(Sphere{{0.1, -0.05, -4}, 1}, mirror());
    c.builder.add(square({0, 0, 3}, {0, 0.2, -1}, 60), glowing(dvec3(1)));
    check(c);
}

TEST(RefocusMatrix, ConcaveSphereMirror) {
    Case c{"concave sphere mirror", {}, chain("R"), spread};
    c.builder.add(Sphere{{0, 0.1, 1}, 4}, mirror());  // the camera is inside
    c.builder.add(square({0.2, 0, 1.5}, {0, 0, -1}, 4), glowing(dvec3(1)));
    check(c);
}

TEST(RefocusMatrix, GlassSphere) {
    Case c{"glass sphere", {}, chain("TT"), spread};
    c.builder.add(Sphere{{0, 0, -4}, 1}, glass(1.5));
    c.builder.add(square({0, 0, -12}, {0.2, 0, 1}, 60), glowing(dvec3(1)));
    check(c);
}

TEST(RefocusMatrix, GlassSphereWithAnInnerReflection) {
    Material both = glass(1.5, 0.9);
    both.reflection = dvec3(0.1);
    Case c{"glass sphere, TRT", {}, chain("TRT"), {{30, 25}, {34, 22}}};
    c.builder.add(Sphere{{0, 0, -4}, 1}, both);
    c.builder.add(square({0, 0, 2}, {0, 0, -1}, 60), glowing(dvec3(1)));
    check(c);
}

TEST(RefocusMatrix, ThickSlabTilted) {
    Case c{"slab", {}, chain("TT"), spread};
    const glm::dmat4 tilt =
        glm::translate(glm::dmat4(1), dvec3(0, 0, -3)) * glm::rotate(glm::dmat4(1), 0.4, dvec3(0.2, 1, 0));
    c.builder.add(Box{{-2, -2, -0.3}, {2, 2, 0.3}}, glass(1.6), tilt);
    c.builder.add(square({0, 0, -9}, {0, 0.3, 1}, 30), glowing(dvec3(1)));
    check(c);
}

TEST(RefocusMatrix, MirrorInMirror) {
    Case c{"mirror in mirror", {}, chain("RR"), spread};
    c.builder.add(Sphere{{0, 0, -4}, 1.5}, mirror());
    c.builder.add(square({0, 0, 2}, {0.1, 0, -1}, 20), mirror());
    c.builder.add(square({0, 0, -30}, {0, 0, 1}, 400), glowing(dvec3(1)));
    check(c);
}

TEST(RefocusMatrix, EveryPrimitivesCurvature) {
    const dvec3 front{0, 0, -4};
    struct Named {
        const char* name;
        Shape shape;
        glm::dmat4 placed;
    };
    const glm::dmat4 at = glm::translate(glm::dmat4(1), front);
    const std::vector<Named> shapes{
        {"cylinder", Cone{{0.1, -2, -4.5}, {0, 2, -4}, 0.8, 0.8}, glm::dmat4(1)},
        {"cone", Cone{{0, -2, -4.2}, {0.1, 2, -4}, 1.2, 0.4}, glm::dmat4(1)},
        {"disc", Disc{front, {0.1, 0.2, 1}, 2}, glm::dmat4(1)},
        {"plane", Plane{front, {-0.1, 0.1, 1}}, glm::dmat4(1)},
        {"ellipsoid", Sphere{},
         at * glm::rotate(glm::dmat4(1), 0.5, dvec3(0, 1, 1)) *
             glm::scale(glm::dmat4(1), dvec3(1.5, 1, 0.6))},
        {"squeezed cylinder", Cone{{0, 0, -2}, {0, 0, 2}, 1, 1},
         at * glm::rotate(glm::dmat4(1), 1.4, dvec3(1, 0.1, 0)) *
             glm::scale(glm::dmat4(1), dvec3(1.4, 0.7, 1))},
    };
    for (const Named& s : shapes) {
        Case c{s.name, {}, chain("R"), {{32, 24}, {31, 25}, {33.5, 22}}};
        c.builder.add(s.shape, mirror(), s.placed);
        c.builder.add(square({0, 0, 4}, {0, 0.2, -1}, 900), glowing(dvec3(1)));
        check(c);
    }
}

TEST(RefocusMatrix, SmoothMeshFollowsItsInterpolatedNormals) {
    // A baked and an instanced mesh, rotated and scaled.
    const auto mesh = sphere_mesh(24, 48, true);
    const glm::dmat4 placed = glm::translate(glm::dmat4(1), dvec3(0.05, 0, -4)) *
                              glm::rotate(glm::dmat4(1), 0.7, dvec3(1, 1, 0)) *
                              glm::scale(glm::dmat4(1), dvec3(1, 1.3, 0.8));
    for (const bool instanced : {false, true}) {
        Case c{instanced ? "instanced mesh" : "mesh",
               {},
               chain("R"),
               {{32.3, 24.2}, {30.1, 25.4}, {34.2, 21.3}}};
        c.builder.add(mesh, mirror(), placed);
        if (instanced) c.builder.add(mesh, mirror(), glm::translate(glm::dmat4(1), dvec3(50, 0, 0)));
        c.builder.add(square({0, 0, 3}, {0, 0.2, -1}, 900), glowing(dvec3(1)));
        check(c);
    }
}

TEST(RefocusMatrix, WhatLeavesTheSceneHoldsItsDirection) {
    Case flat{"sky in a flat mirror", {}, chain("R"), spread, true};
    flat.builder.add(square({0, 0, -2}, {0.1, 0, 1}, 5), mirror());
    check(flat);
    Case curved{"sky in a sphere", {}, chain("R"), spread, true};
    curved.builder.add(Sphere{{0, 0, -4}, 1}, mirror());
    check(curved);
    Case glass_ball{"sky in a glass ball", {}, chain("TT"), spread, true};
    glass_ball.builder.add(Sphere{{0, 0, -4}, 1}, glass(1.5));
    check(glass_ball);
}

TEST(RefocusMatrix, AFoldStaysFinite) {
    // At a caustic the image of the far wall is at the lens itself.
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 2}, mirror());  // the pinhole is at the centre, so rays return along themselves
    const RayScene rays(b.scene, 0);
    const CameraModel camera(b.scene.cameras[0], 0);
    TracedSamples traced;
    RayCounts counts;
    WhittedTracer(rays, camera, {}).trace(std::vector<dvec2>{{32, 24}, {10, 5}}, traced, counts);
    for (const Record& r : traced.records) {
        for (const float v : {r.w.xx, r.w.xy, r.w.yx, r.w.yy}) EXPECT_TRUE(std::isfinite(v));
    }
}

}  // namespace
}  // namespace postlens::test::refocus_test
