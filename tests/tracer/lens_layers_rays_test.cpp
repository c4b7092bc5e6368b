// Hidden surfaces that a lens sees, against rays from the lens, and in mirrors and glass.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/scene_builder.h"
#include "tests/tracer/lens_plates.h"
#include "tracer/shading_trees/lens_reach.h"

namespace postlens::test::lens_layers_rays_test {
namespace {

using glm::dvec3;

// Whether a ray from a point on the lens's rim, or on a ring inside it, hits the given surface point first.
bool seen_from_lens(const RayScene& rays, const CameraModel& camera, const dvec3& point) {
    RayBatch batch;
    batch.clear(false);
    std::vector<double> reach;
    for (int i = 0; i < 48; ++i) {
        const double a = 2 * 3.14159265358979 * (i % 24) / 24, r = radius_m * (i < 24 ? 0.999 : 0.6);
        const dvec3 from = camera.position + r * (std::cos(a) * camera.right + std::sin(a) * camera.down);
        reach.push_back(glm::length(point - from));
        batch.add(from, (point - from) / reach.back(), std::numeric_limits<float>::infinity());
    }
    rays.intersect(batch, false);
    for (std::size_t i = 0; i < reach.size(); ++i) {
        if (batch.hit(i).valid() && std::abs(static_cast<double>(batch.t[i]) - reach[i]) < 1e-3 * reach[i])
            return true;
    }
    return false;
}

// Checks that every hidden surface that rays from the lens find is recorded for the lens. Counts the recorded
// surfaces, and those of them that rays find.
struct Tally {
    int chosen = 0, seen = 0;
};
Tally expect_all_seen_chosen(const Scene& scene) {
    const RayScene rays(scene, 0);
    const CameraModel camera(scene.cameras[0], 0);
    const Places all = places(sampled(scene, false, HiddenLayers::most)), some = places(chosen(scene));
    Tally tally;
    int missed = 0;
    for (const auto& [at, layers] : some) {
        const auto known = all.find(at);
        if (known == all.end()) continue;  // sampled only because of edges of other hidden surfaces
        for (const auto& [layer, nodes] : known->second) {
            if (layer == 0) continue;
            const Record& r = nodes.front();
            const CameraRay eye = camera.ray(static_cast<double>(at.second), static_cast<double>(at.first));
            const bool is_chosen = layers.contains(layer);
            tally.chosen += is_chosen ? 1 : 0;
            if (r.id == 0) continue;
            const dvec3 point = eye.origin + eye.direction * (static_cast<double>(r.z) / eye.cos_axis);
            if (!seen_from_lens(rays, camera, point)) continue;
            ++tally.seen;
            if (is_chosen) continue;
            ++missed;
            // A missed surface behind one other must have a displacement that is not visible. Behind several
            // surfaces, the edge of one may be hidden by another one; this is rare and accepted.
            const double part = gain_px_m * std::abs(1 / static_cast<double>(layers.at(0).front().z) -
                                                     1 / static_cast<double>(r.z));
            if (layer == 1) {
                EXPECT_LT(part, HiddenLayers::invisible_px) << at.second << ' ' << at.first;
            }
        }
    }
    EXPECT_LE(missed, tally.seen / 50);
    return tally;
}

TEST(LensLayersAgainstRays, PlatesBehindPlates) {
    SceneBuilder b = wide();
    add_plate(b, 1, 40.3);
    add_plate(b, 2, 38.6);  // its edge is hidden behind the first
    add_plate(b, 3, 44.8);  // extends beyond the first two
    add_wall(b, 9);
    const Tally t = expect_all_seen_chosen(b.scene);
    EXPECT_GT(t.seen, 1000);
    // Three layers in a strip of at most 6.4 px, each with its margin.
    EXPECT_LT(t.chosen, 2.2 * t.seen);
}

TEST(LensLayersAgainstRays, BallsAndBoxes) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int scene = 0; scene < 3; ++scene) {
        SceneBuilder b = wide();
        for (int i = 0; i < 6; ++i) {
            const double z = 1.2 + 0.6 * i;
            const dvec3 at{0.25 * z * any(random), 0.18 * z * any(random), -z};
            if (i % 2 == 0) {
                b.add(Sphere{at, 0.08 * z}, glowing({1, 0, 0}));
            } else {
                b.add(Box{at - 0.05 * z, at + 0.05 * z}, glowing({0, 0, 1}));
            }
        }
        b.add(Plane{{0, -1, 0}, {0, 1, 0}}, glowing({0.5, 0.5, 0}));
        add_wall(b, 9);
        const Tally t = expect_all_seen_chosen(b.scene);
        EXPECT_GT(t.seen, 500);
        EXPECT_LT(t.chosen, 3 * t.seen);
    }
}

TEST(LensLayersInMirrors, AFlatMirrorShowsWhatStandsBehindIt) {
    // A plate at 5 m and a wall at 8 m, seen directly and in a mirror at 2 m.
    const double edge_px = 50.3;
    SceneBuilder direct = wide();
    add_plate(direct, 5, edge_px);
    add_wall(direct, 8);
    SceneBuilder mirrored = wide();
    const double end = (edge_px - width_px / 2.0) / gain_px * 5;
    mirrored.add(Rectangle{{end - 40, -20, 1}, {40, 0, 0}, {0, 40, 0}}, glowing({1, 0, 0}));
    mirrored.add(square({0, 0, 4}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    mirrored.add(square({0, 0, -2}, {0, 0, 1}, 100), mirror(0.5));
    const Places a = places(chosen(direct.scene)), b = places(chosen(mirrored.scene));
    int behind = 0;
    for (const auto& [at, layers] : b) {
        ASSERT_TRUE(layers.at(0).front().path.bits() == 0);
        const auto there = a.find(at);
        if (there == a.end()) continue;
        ASSERT_EQ(layers.contains(1), there->second.contains(1)) << at.second << ' ' << at.first;
        if (!layers.contains(1)) continue;
        ++behind;
        ASSERT_EQ(layers.at(1).size(), 1U);
        const Record& r = layers.at(1).front();
        EXPECT_EQ(r.path.text(), "R");
        EXPECT_EQ(r.id, 2U);
        EXPECT_EQ(r.g, 0.5F);
        EXPECT_FLOAT_EQ(r.z, 8);
        EXPECT_NEAR(r.w.xx, 1 / 8.0, 1e-6);
        EXPECT_NEAR(r.w.yx, 0, 1e-6);
    }
    EXPECT_GT(behind, 2 * height_px);
}

TEST(LensLayersInMirrors, LayersComeAfterThoseOfThePrimary) {
    // The mirror ends in front of a wall, at the same raster position as the plate that it shows.
    SceneBuilder b = wide();
    const double end = (50.3 - width_px / 2.0) / gain_px;
    b.add(Rectangle{{end * 5 - 40, -20, 1}, {40, 0, 0}, {0, 40, 0}}, glowing({1, 0, 0}));
    b.add(square({0, 0, 4}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    b.add(Rectangle{{(end + 3 / gain_px) * 2 - 40, -20, -2}, {40, 0, 0}, {0, 40, 0}}, mirror(0.5));
    b.add(square({0, 0, -6}, {0, 0, 1}, 100), matte({0.5, 0.5, 0.5}));
    int both = 0;
    for (const auto& [at, layers] : places(chosen(b.scene))) {
        std::uint32_t last_primary = 0;
        for (const auto& [layer, nodes] : layers) {
            if (nodes.front().path.bits() == 0) {
                last_primary = layer;
            } else {
                ++both;
                EXPECT_GT(layer, last_primary);
                // A layer is one subtree: all its paths begin with the path of the root.
                const NodePath root = nodes.front().path;
                for (const Record& r : nodes) {
                    EXPECT_EQ(r.path.bits() & ((1U << (2 * root.depth())) - 1), root.bits());
                }
            }
        }
    }
    EXPECT_GT(both, height_px);
}

TEST(LensLayersInMirrors, BehindGlass) {
    // A pane in front of a bar in front of a wall: the strip hidden by the bar is seen through the pane.
    SceneBuilder b = wide();
    b.add(Box{{-5, -5, -1.02}, {5, 5, -1}}, glass(1.5));
    b.add(Box{{-0.05, -5, -2.1}, {0.05, 5, -2}}, glowing({1, 0, 0}));
    add_wall(b, 8);
    int behind = 0, bar = 0;
    for (const auto& [at, layers] : places(chosen(b.scene))) {
        for (const Record& r : layers.at(0)) bar += r.path.text() == "TT" && r.id == 2 ? 1 : 0;
        for (const auto& [layer, nodes] : layers) {
            if (layer > 0 && nodes.front().path.text() == "TT" && nodes.front().id == 3) ++behind;
        }
    }
    // The bar is 6.7 px wide, less than the strips at its two edges, so the wall is recorded behind all of
    // it.
    EXPECT_GT(bar, 6 * height_px);
    EXPECT_EQ(behind, bar);
}

}  // namespace
}  // namespace postlens::test::lens_layers_rays_test
