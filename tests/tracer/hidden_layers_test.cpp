// Hidden layers: the surfaces that an eye ray enters in sequence, their shading, and those that motion during
// a shutter may reveal.
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <vector>

#include "core/threads.h"
#include "records/record_check.h"
#include "scene/object_parts.h"
#include "tests/support/quads.h"
#include "tests/support/scene_builder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/recording/recorded_motion.h"
#include "tracer/shading_trees/hidden_surfaces.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test::hidden_layers_test {
namespace {

using glm::dvec2;
using glm::dvec3;

const dvec2 centre{32, 24};  // the optical axis of SceneBuilder's camera
constexpr float nothing = std::numeric_limits<float>::infinity();

std::vector<Record> trace_at(const Scene& scene, dvec2 at, const HiddenLayers& hidden,
                             RayCounts* counts_out = nullptr) {
    const RayScene rays(scene, scene.time_s);
    const CameraModel camera(scene.cameras.at(0), scene.time_s);
    TracedSamples traced;
    RayCounts counts;
    WhittedTracer(rays, camera, {.min_contribution = 0}, hidden)
        .trace(std::vector<dvec2>{at}, traced, counts);
    if (counts_out != nullptr) *counts_out = counts;
    return traced.records;
}

// Layer, id and z' of the primary nodes.
struct Met {
    std::uint32_t layer, id;
    float z;
};
std::vector<Met> surfaces(const std::vector<Record>& records) {
    std::vector<Met> out;
    for (const Record& r : records) {
        if (r.path.bits() == 0) out.push_back({r.layer, r.id, r.z});
    }
    return out;
}

// Compares surfaces exactly: z' is computed in double from coordinates that are short binary fractions.
void expect_surfaces(const std::vector<Record>& records, const std::vector<Met>& expected) {
    const std::vector<Met> got = surfaces(records);
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
        EXPECT_EQ(got[i].layer, expected[i].layer) << i;
        EXPECT_EQ(got[i].id, expected[i].id) << i;
        EXPECT_FLOAT_EQ(got[i].z, expected[i].z) << i;
    }
}

// Three walls, of which the last two face away, and a ball between the first two.
SceneBuilder walls_and_ball() {
    SceneBuilder b;
    b.add(square({0, 0, -2}, {0, 0, 1}, 1), glowing({1, 0, 0}));
    b.add(square({0, 0, -6}, {0, 0, -1}, 100), glowing({0, 1, 0}));
    b.add(square({0, 0, -8}, {0, 0, 1}, 100), glowing({0, 0, 1}));
    b.add(Sphere{{0, 0, -4}, 0.5}, glowing({1, 1, 0}));
    return b;
}

TEST(HiddenLayers, AreTheSurfacesThatARayEnters) {
    const SceneBuilder b = walls_and_ball();
    const std::vector<Met> all{{0, 1, 2}, {1, 4, 3.5F}, {2, 2, 6}, {3, 3, 8}, {4, 0, nothing}};
    for (int n = 0; n <= HiddenLayers::most; ++n) {
        const auto count = std::min<std::size_t>(static_cast<std::size_t>(n) + 1, all.size());
        expect_surfaces(trace_at(b.scene, centre, {n}),
                        {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)});
    }
    // One ray passes beside the ball, the other beside the first wall; z' is measured along the axis.
    expect_surfaces(trace_at(b.scene, {48, 24}, {16}), {{0, 1, 2}, {1, 2, 6}, {2, 3, 8}, {3, 0, nothing}});
    expect_surfaces(trace_at(b.scene, {63, 5}, {16}), {{0, 2, 6}, {1, 3, 8}, {2, 0, nothing}});
}

TEST(HiddenLayers, AreLeftOutOfSamplesThatOnlyServeToCompareColours) {
    const SceneBuilder b = walls_and_ball();
    const RayScene rays(b.scene, b.scene.time_s);
    const CameraModel camera(b.scene.cameras.at(0), b.scene.time_s);
    const WhittedTracer tracer(rays, camera, {}, {.count = 4});
    const std::vector<dvec2> positions{centre, {48, 24}, {63, 5}};
    TracedSamples all, steady;
    RayCounts counts;
    tracer.trace_steady(positions, steady, counts);
    EXPECT_EQ(counts.hidden, 0U);
    tracer.trace(positions, all, counts);
    EXPECT_GT(counts.hidden, 0U);
    std::erase_if(all.records, [](const Record& r) { return r.layer > 0; });
    EXPECT_EQ(steady.records, all.records);
}

TEST(HiddenLayers, NothingIsRecordedOnce) {
    SceneBuilder b;
    expect_surfaces(trace_at(b.scene, centre, {5}), {{0, 0, nothing}});
    b.add(square({0, 0, -2}, {0, 0, 1}, 1), glowing({1, 0, 0}));
    b.scene.background = {0.25, 0.5, 0.75};
    const std::vector<Record> records = trace_at(b.scene, centre, {5});
    expect_surfaces(records, {{0, 1, 2}, {1, 0, nothing}});
    EXPECT_EQ(records[1].r, 0.25F);
    EXPECT_EQ(records[1].w, Mat2());
}

TEST(HiddenLayers, TheWayOutOfASolidIsNoSurface) {
    const auto through = [](Shape shape) {
        SceneBuilder b;
        b.add(std::move(shape), glowing({1, 0, 0}));
        b.add(square({0, 0, -8}, {0, 0, 1}, 100), glowing({0, 0, 1}));
        return trace_at(b.scene, centre, {16});
    };
    const std::vector<Met> expected{{0, 1, 3}, {1, 2, 8}, {2, 0, nothing}};
    expect_surfaces(through(Box{{-1, -1, -5}, {1, 1, -3}}), expected);
    expect_surfaces(through(Sphere{{0, 0, -4}, 1}), expected);
    expect_surfaces(through(Cone{{0, 0, -5}, {0, 0, -3}, 1, 1, true}), expected);
    // Flat objects have no inside, so a disc hit from behind counts as a surface.
    expect_surfaces(through(Disc{{0, 0, -3}, {0, 0, -1}, 1}), expected);
    // A mesh of a ball, shifted so that the ray does not hit a vertex.
    SceneBuilder b;
    b.add(sphere_mesh(9, 14, false), glowing({1, 0, 0}),
          glm::translate(glm::dmat4(1), dvec3(0.013, 0.02, -4)));
    b.add(square({0, 0, -8}, {0, 0, 1}, 100), glowing({0, 0, 1}));
    const std::vector<Met> mesh = surfaces(trace_at(b.scene, centre, {16}));
    ASSERT_EQ(mesh.size(), 3U);
    EXPECT_EQ(mesh[1].id, 2U);
    EXPECT_FLOAT_EQ(mesh[1].z, 8);
}

// A ray through two leaves of one mesh, which face opposite ways, has not left the first one at the second.
TEST(HiddenLayers, TheBackOfAnotherPartIsNoWayOut) {
    const auto facing = [](double z, double turn) {
        return Quad{dvec3(-turn, -1, z), dvec3(turn, -1, z), dvec3(turn, 1, z), dvec3(-turn, 1, z)};
    };
    SceneBuilder b;
    b.add(mesh_of({facing(-2, 1), facing(-3, -1), facing(-4, 1)}), glowing({1, 0, 0}));
    b.add(square({0, 0, -8}, {0, 0, 1}, 100), glowing({0, 0, 1}));
    const ObjectParts parts(b.scene);
    expect_surfaces(trace_at(b.scene, {33.5, 25}, {.count = 16, .parts = &parts}),
                    {{0, 1, 2}, {1, 1, 3}, {2, 1, 4}, {3, 2, 8}, {4, 0, nothing}});
}

TEST(HiddenLayers, WhatCoincidesWithAWayOutIsFound) {
    // For a box on a floor, the ray leaves the box at the point where it enters the floor.
    SceneBuilder b;
    b.scene.cameras[0].look_at = {0, -1, -1};
    b.add(Box{{-3, -2, -3}, {3, -1, -1.25}}, glowing({1, 0, 0}));
    b.add(square({0, -2, 0}, {0, 1, 0}, 100), glowing({0, 0, 1}));
    for (int x = 4; x < 64; x += 7) {
        const std::vector<Met> got = surfaces(trace_at(b.scene, {x + 0.25, 24.375}, {16}));
        ASSERT_EQ(got.size(), 3U) << x;
        EXPECT_EQ(got[0].id, 1U);
        EXPECT_EQ(got[1].id, 2U);
        EXPECT_EQ(got[2].id, 0U);
    }
    // Two coincident sheets are two surfaces.
    SceneBuilder c;
    c.add(square({0, 0, -2}, {0, 0, 1}, 1), glowing({1, 0, 0}));
    c.add(square({0, 0, -2}, {0, 0, 1}, 1.5), glowing({0, 1, 0}));
    const std::vector<Met> both = surfaces(trace_at(c.scene, {33.5, 25.5}, {16}));
    ASSERT_EQ(both.size(), 3U);
    EXPECT_NE(both[0].id, both[1].id);
    EXPECT_EQ(both[1].z, both[0].z);
    EXPECT_EQ(both[2].id, 0U);
}

TEST(HiddenLayers, ACameraInsideSeesTheWayOut) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 1}, glowing({1, 0, 0}));
    b.add(Sphere{{0, 0, 0}, 3}, glowing({0, 1, 0}));
    b.add(Sphere{{0, 0, -6}, 1}, glowing({0, 0, 1}));
    expect_surfaces(trace_at(b.scene, centre, {16}), {{0, 1, 1}, {1, 2, 3}, {2, 3, 5}, {3, 0, nothing}});
}

TEST(HiddenLayers, ObjectsInsideOthersAreEntered) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -5}, 2}, glass(1.5));
    b.add(Box{{-1, -1, -5.5}, {1, 1, -4.5}}, glowing({1, 0, 0}));
    b.add(Sphere{{0, 0, -7}, 1}, glowing({0, 1, 0}));  // partly inside the glass ball
    expect_surfaces(trace_at(b.scene, centre, {16}), {{0, 1, 3}, {1, 2, 4.5F}, {2, 3, 6}, {3, 0, nothing}});
}

TEST(HiddenLayers, BehindAMirrorIsTheWallBehindIt) {
    SceneBuilder b;
    b.add(square({0, 0, -2}, {0, 0, 1}, 4), mirror(0.5));
    b.add(square({0, 0, -3}, {0, 0, 1}, 100), glowing({0, 1, 0}));
    b.add(square({0, 0, 4}, {0, 0, -1}, 100), glowing({1, 0, 0}));
    const std::vector<Record> records = trace_at(b.scene, centre, {1});
    ASSERT_EQ(records.size(), 3U);
    EXPECT_EQ(records[1].path.text(), "R");
    EXPECT_EQ(records[1].id, 3U);
    EXPECT_EQ(records[2].layer, 1U);
    EXPECT_EQ(records[2].id, 2U);
    EXPECT_EQ(records[2].path.bits(), 0U);
    EXPECT_FLOAT_EQ(records[2].z, 3);
    EXPECT_EQ(records[2].g, 1);
    EXPECT_EQ(records[2].w, Mat2::isotropic(1 / records[2].z));
}

TEST(HiddenLayers, AreShadedAsIfNothingStoodBefore) {
    // Records behind a curtain equal those without the curtain, including reflections and W.
    const auto scene = [](bool curtain) {
        SceneBuilder b;
        Material shiny = mirror(0.6);
        shiny.diffuse = dvec3(0.3);
        b.add(Sphere{{0.1, 0, -5}, 1}, shiny);
        b.add(square({0, -2, 0}, {0, 1, 0}, 100), matte({0.5, 0.5, 0.2}));
        b.point_light({2, 3, 1});
        b.scene.ambient_light = dvec3(0.1);
        // The curtain casts no shadows, so it only changes the first surface.
        if (curtain) b.add(square({0, 0, -1}, {0, 0, 1}, 10), glowing({1, 0, 0})).casts_shadows = false;
        return b.scene;
    };
    int deeper = 0;
    for (const dvec2 at : {dvec2(32, 24), dvec2(30.25, 20.5), dvec2(40, 30), dvec2(20.125, 26)}) {
        const std::vector<Record> bare = trace_at(scene(false), at, {0});
        std::vector<Record> behind = trace_at(scene(true), at, {1});
        behind.erase(behind.begin(), std::find_if(behind.begin(), behind.end(),
                                                  [](const Record& r) { return r.layer == 1; }));
        for (Record& r : behind) r.layer = 0;
        // Reflected rays that hit the curtain's back end there only in the scene with the curtain.
        if (std::any_of(behind.begin(), behind.end(), [](const Record& r) { return r.id == 3; })) continue;
        EXPECT_EQ(behind, bare);
        deeper += bare.size() > 1 ? 1 : 0;
    }
    EXPECT_GT(deeper, 0);
}

TEST(HiddenLayers, TheirRaysAreCountedApart) {
    const SceneBuilder b = walls_and_ball();
    RayCounts counts;
    (void)trace_at(b.scene, centre, {2}, &counts);
    EXPECT_EQ(counts.eye, 1U);
    EXPECT_EQ(counts.eye_hits, 1U);
    EXPECT_EQ(counts.hidden, 3U);  // into the ball, out of it, to the wall
    (void)trace_at(b.scene, centre, {0}, &counts);
    EXPECT_EQ(counts.hidden, 0U);
}

// All records of a traced image.
std::vector<Record> sampled(const Scene& scene, const HiddenLayers& hidden, double time_s = 0) {
    const RayScene rays(scene, time_s);
    const CameraModel camera(scene.cameras.at(0), time_s);
    const WhittedTracer tracer(rays, camera, {}, hidden);
    std::vector<Record> out;
    (void)sample_corners(tracer, {0, 64, 0, 48}, {.levels = 2}, [&](const RecordBand& band) {
        for (int y = band.y_begin; y < band.y_end; ++y) {
            for (int x = band.x_begin; x < band.x_end; ++x) {
                const std::size_t k = band.pixel(x, y);
                const auto pixel =
                    std::span(band.records).subspan(band.offsets[k], band.offsets[k + 1] - band.offsets[k]);
                EXPECT_EQ(problem_of_pixel(pixel, x, y, {true, true}), nullptr);
            }
        }
        out.insert(out.end(), band.records.begin(), band.records.end());
    });
    return out;
}
std::vector<Record> visible(std::vector<Record> records) {
    std::erase_if(records, [](const Record& r) { return r.layer != 0; });
    return records;
}

SceneBuilder shiny_scene() {
    SceneBuilder b = walls_and_ball();
    Material m = matte({0.6, 0.5, 0.4});
    m.reflection = dvec3(0.3);
    b.add(Sphere{{-0.3, 0.1, -1.5}, 0.3}, m);
    b.add(Sphere{{0.4, 0.1, -1.4}, 0.2}, glass(1.5, 0.9));
    b.add(sphere_mesh(7, 9, true), m, glm::translate(glm::dmat4(1), dvec3(1.5, 0.3, -5)));
    b.point_light({2, 3, 0});
    return b;
}

TEST(HiddenLayers, TheVisibleLayerHasTheSameBits) {
    const SceneBuilder b = shiny_scene();
    const std::vector<Record> bare = sampled(b.scene, {});
    for (const int n : {1, 3, 16}) {
        const std::vector<Record> with = sampled(b.scene, {n});
        EXPECT_GT(with.size(), bare.size());
        // Edges of hidden surfaces add samples. Samples that also exist without hidden layers are unchanged.
        const std::vector<Record> seen = visible(with);
        auto at = seen.begin();
        for (const Record& r : bare) {
            at = std::find(at, seen.end(), r);
            ASSERT_NE(at, seen.end()) << n << " at " << r.x << ", " << r.y;
        }
    }
}

TEST(HiddenLayers, SameBitsForAnyNumberOfThreads) {
    const SceneBuilder b = shiny_scene();
    std::vector<Record> first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const std::vector<Record> got = sampled(b.scene, {16});
        if (first.empty()) first = got;
        EXPECT_EQ(got, first) << threads;
    }
}

// What comes to light ----------------------------------------------------------------------------------

struct Uncovered {
    std::vector<Record> all, chosen;
};
Uncovered uncovered(const Scene& scene, double open_s = 0, double close_s = 1) {
    const SceneMotion motion = recorded_motion(scene, scene.cameras[0]);
    const std::vector<double> recorded{0.0};
    const FilmMotion film(motion, scene.cameras[0], {}, 0,
                          looked_at_instants(motion, open_s, close_s, recorded));
    return {sampled(scene, {HiddenLayers::most}), sampled(scene, {HiddenLayers::most, &film})};
}

// Per raster position, the id of each layer.
using Chains = std::map<std::pair<float, float>, std::map<std::uint32_t, std::uint32_t>>;
Chains chains(const std::vector<Record>& records) {
    Chains out;
    for (const Record& r : records) {
        if (r.path.bits() == 0) out[{r.y, r.x}][r.layer] = r.id;
    }
    return out;
}

Object& moving_ball(SceneBuilder& b, double z, double way) {
    Object& ball = b.add(Sphere{{0, 0, 0}, 0.3}, glowing({1, 1, 0}));
    ball.keys = {{.time_s = 0, .translation = {-0.5 * way, 0, z}},
                 {.time_s = 1, .translation = {0.5 * way, 0, z}}};
    return ball;
}

TEST(ComesToLight, BehindAMovingBallAndNowhereElse) {
    SceneBuilder b;
    b.add(square({0, 0, -6}, {0, 0, 1}, 100), glowing({0, 1, 0}));
    b.add(square({0, 0, -8}, {0, 0, 1}, 100), glowing({0, 0, 1}));
    b.add(square({1, 0, -3}, {0, 0, 1}, 0.5), glowing({1, 0, 0}));
    const std::uint32_t ball = moving_ball(b, -4, 1).id;
    const Uncovered u = uncovered(b.scene);
    EXPECT_EQ(visible(u.chosen), visible(u.all));
    int behind = 0;
    for (const auto& [at, layers] : chains(u.chosen)) {
        if (layers.at(0) == ball) {
            EXPECT_EQ(layers, (std::map<std::uint32_t, std::uint32_t>{{0, ball}, {1, 1}}));
            ++behind;
        } else {
            EXPECT_EQ(layers.size(), 1U);
        }
    }
    EXPECT_GT(behind, 100);
}

TEST(ComesToLight, AMovingBallBehindAPost) {
    SceneBuilder b;
    b.add(Box{{-0.05, -2, -2.1}, {0.05, 2, -2}}, glowing({1, 0, 0}));
    b.add(square({0, 0, -6}, {0, 0, 1}, 100), glowing({0, 1, 0}));
    const std::uint32_t ball = moving_ball(b, -4, 0.4).id;
    const Uncovered u = uncovered(b.scene);
    int behind_post = 0;
    const Chains all = chains(u.all);
    for (const auto& [at, layers] : chains(u.chosen)) {
        const bool hides_ball = layers.at(0) == 1 && all.at(at).contains(1) && all.at(at).at(1) == ball;
        if (hides_ball) ++behind_post;
        if (layers.at(0) == 1) {
            EXPECT_EQ(layers.contains(1), hides_ball) << at.second << ' ' << at.first;
        }
        // The wall behind the ball is recorded, except where the still post stays in front of it.
        EXPECT_EQ(layers.contains(2), false);
    }
    EXPECT_GT(behind_post, 10);
}

TEST(ComesToLight, NothingBehindWhatTurnsWithIt) {
    // Two balls in one rigid motion always hide each other, but the wall behind both is revealed.
    SceneBuilder b;
    const std::uint32_t front = moving_ball(b, -3, 1).id;
    Object back = b.scene.objects.back();
    back.id = 2;
    back.shape = Sphere{{0, 0, -1}, 0.3};
    b.scene.objects.push_back(back);
    b.scene.cameras[0].projection = Camera::Projection::orthographic;
    b.scene.cameras[0].orthographic_width_m = 4;
    const Uncovered u = uncovered(b.scene);
    int behind = 0;
    for (const auto& [at, layers] : chains(u.chosen)) {
        if (layers.at(0) != front) continue;
        ++behind;
        EXPECT_EQ(layers, (std::map<std::uint32_t, std::uint32_t>{{0, front}, {2, 0}}));
    }
    EXPECT_GT(behind, 100);
}

TEST(ComesToLight, ATurnOfTheCameraUncoversNothingAStepDoes) {
    SceneBuilder b = walls_and_ball();
    Camera& camera = b.scene.cameras[0];
    camera.keys = {{.time_s = 0},
                   {.time_s = 1, .rotation = glm::angleAxis(0.2, glm::normalize(dvec3(0.2, 1, 0.1)))}};
    Uncovered u = uncovered(b.scene);
    EXPECT_EQ(u.chosen, visible(u.chosen));
    camera.keys[1].rotation = {1, 0, 0, 0};
    camera.keys[1].translation = {0.2, 0, 0};
    u = uncovered(b.scene);
    // The scale is 64 px * 50 / 36 = 88.9 px per unit of tangent. All these surfaces move apart by more than
    // 0.25 px: by at least 88.9 * 0.2 * (1/6 - 1/8) = 0.74 px.
    EXPECT_EQ(u.chosen, u.all);
    // With a slow motion no surfaces move apart that far: at most 88.9 * 0.001 * 1/2 px.
    camera.keys[1].translation = {0.001, 0, 0};
    u = uncovered(b.scene);
    EXPECT_EQ(u.chosen, visible(u.chosen));
}

TEST(ComesToLight, AtMostFourSurfaces) {
    SceneBuilder b;
    for (int i = 0; i < 9; ++i) b.add(square({0, 0, -2 - i}, {0, 0, 1}, 100), glowing({1, 0, 0}));
    b.scene.cameras[0].keys = {{.time_s = 0}, {.time_s = 1, .translation = {5, 0, 0}}};
    const Uncovered u = uncovered(b.scene);
    for (const auto& [at, layers] : chains(u.chosen)) EXPECT_EQ(layers.size(), 5U);
    for (const auto& [at, layers] : chains(u.all)) EXPECT_EQ(layers.size(), 10U);
}

TEST(ComesToLight, WhereNothingMovesNothingDoes) {
    SceneBuilder b = walls_and_ball();
    moving_ball(b, -3, 1);
    const SceneMotion motion = recorded_motion(b.scene, b.scene.cameras[0]);
    const std::vector<double> none;
    EXPECT_FALSE(FilmMotion(motion, b.scene.cameras[0], {}, 0, looked_at_instants(motion, -2, 0, none))
                     .anything_moves());
    const FilmMotion film(motion, b.scene.cameras[0], {}, 0, looked_at_instants(motion, 0, 0.5, none));
    EXPECT_TRUE(film.anything_moves());
    EXPECT_TRUE(film.moves(5));
    EXPECT_FALSE(film.moves(1));
    EXPECT_FALSE(film.parallax());
}

TEST(ComesToLight, WhatMovesOnlyBetweenEvenInstantsDoes) {
    // The nine even instants are 1/8 s apart. The first object moves away and back between two of them. The
    // second makes 16 whole turns, and is in the same position at every even instant.
    SceneBuilder b = walls_and_ball();
    Object& out_and_back = moving_ball(b, -3, 1);
    out_and_back.keys = {{.time_s = 0.01}, {.time_s = 0.05, .translation = {1, 0, 0}}, {.time_s = 0.1}};
    Object& fan = moving_ball(b, -3, 1);
    fan.keys.clear();
    for (int i = 0; i <= 48; ++i) {
        const double angle = 2 * std::numbers::pi * (i % 3) / 3;
        fan.keys.push_back(
            {.time_s = i / 48.0, .rotation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}});
    }
    const SceneMotion motion = recorded_motion(b.scene, b.scene.cameras[0]);
    for (const auto& [id, object] : motion.objects) {
        SceneMotion alone;
        alone.objects[id] = object;
        const std::vector<double> none;
        const FilmMotion film(alone, b.scene.cameras[0], {}, 0, looked_at_instants(alone, 0, 1, none));
        EXPECT_TRUE(film.moves(id)) << id;
    }
    EXPECT_EQ(motion.objects.size(), 2U);
}

}  // namespace
}  // namespace postlens::test::hidden_layers_test
