// Properties of renders for any scene: limiting cases, repeatability, halves.
#include "tracer/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/job.h"
#include "core/threads.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tests/tracer/repeated_renders.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/distributed/render_state.h"

namespace postlens::test::render_test {
namespace {

namespace fs = std::filesystem;
using glm::dvec3;

constexpr double infinity = std::numeric_limits<double>::infinity();

// A scene with gloss, glass, area lights, and motion of objects, a light and the camera.
SceneBuilder busy_scene(bool motion = true) {
    SceneBuilder b;
    Camera& c = b.scene.cameras[0];
    c.width = 30;  // not a multiple of a tile
    c.height = 21;
    Material glossy = matte({0.3, 0.5, 0.4});
    glossy.reflection = dvec3(0.4);
    glossy.reflection_exponent = 80;
    b.add(Sphere{{-0.5, 0, -3}, 0.5}, glossy);
    b.add(Sphere{{0.8, 0.1, -2.5}, 0.3}, glass(1.5, 0.9));
    b.add(Plane{{0, -0.5, 0}, {0, 1, 0}}, matte(dvec3(0.6)));
    Object& mesh = b.add(sphere_mesh(4, 6, false), matte({0.9, 0.8, 0.2}));
    mesh.world_from_object = glm::translate(glm::dmat4(1), dvec3(0.2, 0.9, -4));
    Light& lamp = b.point_light({2, 3, 0}, dvec3(0.8));
    lamp.kind = Light::Kind::sphere;
    lamp.radius = 0.5;
    b.point_light({-3, 2, 1}, dvec3(0.3));
    if (!motion) return b;
    mesh.keys.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
        mesh.keys[i].time_s = 0.4 * static_cast<double>(i);
        mesh.keys[i].translation = dvec3(-0.5 + 0.5 * static_cast<double>(i * i), 0.5, -4);
        mesh.keys[i].rotation = glm::angleAxis(0.5 * static_cast<double>(i), dvec3(0, 0, 1));
    }
    b.scene.lights[1].keys.resize(2);
    b.scene.lights[1].keys[1].time_s = 1;
    b.scene.lights[1].keys[1].translation = {0.5, 0, 0};
    c.keys = b.scene.lights[1].keys;
    c.keys[1].translation = {0.05, 0, 0};
    return b;
}

RenderSettings everything(int spp = 8) {
    RenderSettings s;
    s.f_number = 1.4;
    s.focus_m = 3;
    s.shutter = TimeSpan{0.2, 0.7};
    s.curve = ShutterCurve::triangle();
    s.spp = spp;
    return s;
}

TEST(RenderLimits, AnInfiniteFNumberIsAPinhole) {
    const Scene scene = busy_scene(false).scene;
    RenderSettings s;
    s.spp = 8;
    const Image pinhole = render_picture(scene, s).image;
    s.f_number = infinity;
    s.focus_m = 0.7;
    EXPECT_EQ(render_picture(scene, s).image.rgb, pinhole.rgb);
    s.f_number = 2;
    EXPECT_NE(render_picture(scene, s).image.rgb, pinhole.rgb);
    // A lens with CoCs of 1e-5 px: only the few rays within this distance of an outline may differ.
    s.f_number = 1e7;
    const Image nearly = render_picture(scene, s).image;
    int other = 0;
    for (std::size_t i = 0; i < nearly.rgb.size(); ++i)
        other += std::abs(nearly.rgb[i] - pinhole.rgb[i]) > 1e-2F ? 1 : 0;
    EXPECT_LE(other, 9);
}

TEST(RenderLimits, AShutterOfNoTimeIsAStill) {
    const Scene scene = busy_scene().scene;
    RenderSettings s = everything();
    s.shutter.reset();
    s.time_s = 0.45;
    const Image still = render_picture(scene, s).image;
    s.shutter = TimeSpan{0.45, 0.45};
    EXPECT_EQ(render_picture(scene, s).image.rgb, still.rgb);
    s.time_s.reset();
    EXPECT_EQ(render_picture(scene, s).image.rgb, still.rgb);
    s.curve = ShutterCurve::box();
    EXPECT_EQ(render_picture(scene, s).image.rgb, still.rgb);
    s.shutter = TimeSpan{0.45, 0.55};
    EXPECT_NE(render_picture(scene, s).image.rgb, still.rgb);
}

// In a still scene, the shutter interval and its curve have no effect.
TEST(RenderLimits, AnOpenShutterBeforeAStillSceneIsAStill) {
    const Scene scene = busy_scene(false).scene;
    RenderSettings s = everything();
    s.shutter.reset();
    const Image still = render_picture(scene, s).image;
    s.shutter = TimeSpan{-3, 5};
    EXPECT_EQ(render_picture(scene, s).image.rgb, still.rgb);
}

// Camera, lights and all objects have the same motion, so the image is still. Positions at an instant have
// errors of 2^-24 of a few metres, so only samples within 1e-6 of an outline may differ: 1 in 10^4 of the
// about 4000 samples at sharp shadows and outlines.
TEST(RenderLimits, WhatMovesWithTheCameraStandsStill) {
    SceneBuilder b;
    b.scene.cameras[0].width = 24;
    b.scene.cameras[0].height = 18;
    b.add(Sphere{{-0.5, 0, -3}, 0.5}, matte({0.9, 0.2, 0.2}));
    b.add(Box{{0.2, -0.4, -3}, {0.9, 0.4, -2.5}}, matte({0.2, 0.9, 0.2}));
    b.add(sphere_mesh(8, 10, true), matte({0.2, 0.2, 0.9}), glm::translate(glm::dmat4(1), dvec3(0, 0.6, -5)));
    b.add(square({0, 0, -6}, {0, 0, 1}, 9), matte(dvec3(0.8)));
    b.point_light({2, 3, 0}, dvec3(0.9));
    RenderSettings s;
    s.f_number = 1.4;
    s.focus_m = 3;
    s.spp = 16;
    s.shutter = TimeSpan{0, 1};
    const Image still = render_picture(b.scene, s).image;
    std::vector<TransformKey> keys(3);
    keys[1].time_s = 0.4;
    keys[1].translation = {0.4, 0.3, -0.2};
    keys[1].rotation = glm::angleAxis(0.2, glm::normalize(dvec3(1, 2, 0.5)));
    keys[2].time_s = 1;
    keys[2].translation = {0.1, 0.8, 0.5};
    keys[2].rotation = glm::angleAxis(0.4, glm::normalize(dvec3(1, -1, 0.5)));
    for (Object& o : b.scene.objects) {
        o.keys = keys;
        o.motion_base = o.world_from_object;
    }
    b.scene.lights[0].keys = keys;
    b.scene.cameras[0].keys = keys;
    const RenderResult moving = render_picture(b.scene, s);
    int other = 0;
    double sum = 0;
    for (std::size_t i = 0; i < still.rgb.size(); ++i) {
        const auto difference = static_cast<double>(moving.image.rgb[i] - still.rgb[i]);
        sum += difference;
        other += std::abs(difference) > 1e-3 ? 1 : 0;
    }
    // The error of the mesh is motion_error_px <= 0.05 px. Its outline is 40 px long, so 2 px of 432 may
    // change one sample of 16.
    EXPECT_LE(other, static_cast<int>(still.rgb.size()) / 50);
    EXPECT_LE(std::abs(sum) / static_cast<double>(still.rgb.size()), 1e-3);
    // Without the camera's motion the images differ, so the scene does move.
    b.scene.cameras[0].keys.clear();
    const Image unlike = render_picture(b.scene, s).image;
    other = 0;
    for (std::size_t i = 0; i < still.rgb.size(); ++i)
        other += std::abs(unlike.rgb[i] - still.rgb[i]) > 1e-2F ? 1 : 0;
    EXPECT_GT(other, static_cast<int>(still.rgb.size()) / 5);
}

TEST(RenderRepeats, SameBitsForAnyNumberOfThreads) {
    const Scene scene = busy_scene().scene;
    for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::poisson}) {
        // 20 samples are more than one group of 16, and not a multiple of it.
        RenderSettings s = everything(20);
        s.sampler = sampler;
        std::vector<Image> pictures;
        for (const int threads : {1, 5}) {
            const ThreadLimit limit(threads);
            pictures.push_back(render_picture(scene, s).image);
        }
        EXPECT_EQ(pictures[0].rgb, pictures[1].rgb);
    }
}

TEST(RenderRepeats, SeedsDiffer) {
    const Scene scene = busy_scene().scene;
    for (const SamplerKind sampler : {SamplerKind::jittered, SamplerKind::random, SamplerKind::poisson,
                                      SamplerKind::sobol, SamplerKind::grid}) {
        RenderSettings s = everything();
        s.sampler = sampler;
        s.seed = 1;
        const Image one = render_picture(scene, s).image;
        EXPECT_EQ(render_picture(scene, s).image.rgb, one.rgb);
        s.seed = (std::uint64_t{1} << 32) + 1;  // the high bits of a seed have an effect
        EXPECT_NE(render_picture(scene, s).image.rgb, one.rgb);
        s.seed = 2;
        EXPECT_NE(render_picture(scene, s).image.rgb, one.rgb);
    }
}

TEST(RenderHalves, ThePictureIsTheirMean) {
    RenderSettings s = everything(24);
    s.halves = true;
    const RenderResult r = render_picture(busy_scene().scene, s);
    ASSERT_EQ(r.halves[0].rgb.size(), r.image.rgb.size());
    EXPECT_NE(r.halves[0].rgb, r.halves[1].rgb);
    for (std::size_t i = 0; i < r.image.rgb.size(); ++i) {
        const double mean =
            0.5 * (static_cast<double>(r.halves[0].rgb[i]) + static_cast<double>(r.halves[1].rgb[i]));
        // Tolerance: three numbers rounded to float.
        EXPECT_NEAR(static_cast<double>(r.image.rgb[i]), mean, 0x1p-23 * mean) << i;
    }
    s.halves = false;
    EXPECT_TRUE(render_picture(busy_scene().scene, s).halves[0].rgb.empty());
}

// The errors of two halves, against an image with many more samples, are independent. Over n pixels their
// correlation has a standard error of 1 / sqrt(n), plus a bias because the reference's error, 1/64 of theirs
// in variance, is common to both.
TEST(RenderHalves, AreUncorrelated) {
    const Scene scene = busy_scene().scene;
    RenderSettings s = everything(1024);
    s.seed = 1000;
    const Image truth = render_picture(scene, s).image;
    for (const SamplerKind sampler :
         {SamplerKind::sobol, SamplerKind::jittered, SamplerKind::poisson, SamplerKind::random}) {
        s = everything(16);
        s.sampler = sampler;
        s.halves = true;
        double ab = 0, aa = 0, bb = 0;
        std::size_t n = 0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            s.seed = seed;
            const RenderResult r = render_picture(scene, s);
            for (std::size_t i = 0; i < truth.rgb.size(); i += 3, ++n) {
                const auto a = static_cast<double>(r.halves[0].rgb[i] - truth.rgb[i]);
                const auto b = static_cast<double>(r.halves[1].rgb[i] - truth.rgb[i]);
                // Uses signed square roots, so that a few bright pixels do not dominate.
                const double fa = std::copysign(std::sqrt(std::abs(a)), a);
                const double fb = std::copysign(std::sqrt(std::abs(b)), b);
                ab += fa * fb, aa += fa * fa, bb += fb * fb;
            }
        }
        EXPECT_LE(std::abs(ab / std::sqrt(aa * bb)), 4 / std::sqrt(static_cast<double>(n)) + 1.0 / 64);
    }
}

// Neighbouring seeds share no half: halves of different seeds differ as much as the halves of one seed.
TEST(RenderHalves, DifferFromThoseOfOtherSeeds) {
    const Scene scene = busy_scene().scene;
    std::vector<Image> all;
    for (const std::uint64_t seed : {0, 1, 2}) {
        RenderSettings s = everything(16);
        s.halves = true;
        s.seed = seed;
        for (const Image& half : render_picture(scene, s).halves) all.push_back(half);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t k = i + 1; k < all.size(); ++k) EXPECT_NE(all[i].rgb, all[k].rgb) << i << " " << k;
    }
}

TEST(RenderFiles, AreWhatRenderPictureMakes) {
    const TemporaryFolder folder;
    const Scene scene = busy_scene().scene;
    RenderSettings s = everything();
    s.halves = true;
    const fs::path path = folder.path() / "x.exr";
    const RenderResult file = render_to_file(scene, s, path), memory = render_picture(scene, s);
    EXPECT_EQ(read_image(path).rgb, memory.image.rgb);
    EXPECT_EQ(file.image.rgb, memory.image.rgb);
    EXPECT_EQ(read_image(half_paths(path)[0]).rgb, memory.halves[0].rgb);
    EXPECT_EQ(read_image(half_paths(path)[1]).rgb, memory.halves[1].rgb);
    EXPECT_EQ(half_paths(path)[0].filename(), "x.a.exr");
    EXPECT_EQ(partial_path(path).filename(), "x.partial.exr");
    EXPECT_EQ(folder.file_count(), 3U) << "the unfinished picture should be gone";
    EXPECT_EQ(file.rays.eye, memory.rays.eye);
    EXPECT_EQ(file.rays.eye, 30U * 21 * 8);
}

// A run that is interrupted before every pixel has samples reports 0 samples per pixel, but can be resumed.
TEST(RenderFiles, GoOnFromAnUnfinishedFirstRound) {
    const TemporaryFolder folder;
    const Scene scene = busy_scene().scene;
    RenderSettings s = everything();
    const fs::path path = folder.path() / "x.exr";
    const RenderResult fresh = render_to_file(scene, s, path);
    EXPECT_FALSE(fresh.resumed);
    {
        const RenderSetup setup(scene, s);
        write_state(partial_path(path), RenderState(setup.width(), setup.height(), 1), setup.fingerprint(s));
    }
    s.resume = true;
    const RenderResult resumed = render_to_file(scene, s, path);
    EXPECT_TRUE(resumed.resumed);
    EXPECT_EQ(resumed.spp_resumed, 0);
    EXPECT_EQ(resumed.image.rgb, fresh.image.rgb);
    const RenderResult again = render_to_file(scene, s, path);
    EXPECT_FALSE(again.resumed);
    EXPECT_EQ(again.image.rgb, fresh.image.rgb);
}

TEST(RenderFiles, ResolvedLensIsReported) {
    Scene scene = busy_scene(false).scene;
    scene.cameras[0].f_number = 4;
    scene.cameras[0].focus_m = 3;
    RenderSettings s;
    s.spp = 1;
    RenderResult r = render_picture(scene, s);
    EXPECT_EQ(r.f_number, 4);
    EXPECT_EQ(r.focus_m, 3);
    EXPECT_EQ(r.focal_length_mm, 50);
    s.f_number = 2;
    s.focal_length_mm = 85;
    s.focus_at = {29.0, 1.0};  // the background
    r = render_picture(scene, s);
    EXPECT_EQ(r.f_number, 2);
    EXPECT_EQ(r.focal_length_mm, 85);
    EXPECT_EQ(r.focus_m, infinity);
    s.focus_at = {15.0, 20.5};  // on the floor, 0.5 m below
    r = render_picture(scene, s);
    // 10 px below the centre, with 30 px on 36 mm at a film distance of 50 mm: a tangent of 10 * 1.2 / 50.
    EXPECT_NEAR(r.focus_m, 0.5 / (10 * 1.2 / 50), 1e-6);
}

TEST(RenderErrors, SettingsOutOfRange) {
    const Scene scene = busy_scene().scene;
    const auto refused = [&](const RenderSettings& s, const char* part) {
        try {
            (void)render_picture(scene, s);
            ADD_FAILURE() << "expected: " << part;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::wrong_arguments) << e.what();
            EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
        }
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    RenderSettings s = everything();
    for (const int spp : {0, -1, Sampler::max_spp + 1}) {
        s.spp = spp;
        refused(s, "--spp");
    }
    s = everything(7);
    s.halves = true;
    refused(s, "even");
    for (const TimeSpan& bad : {TimeSpan{1, 0}, TimeSpan{nan, 1}, TimeSpan{0, nan}, TimeSpan{0, infinity}}) {
        s = everything();
        s.shutter = bad;
        refused(s, "--shutter");
    }
    for (const int depth : {0, 18}) {
        s = everything();
        s.tracing.max_depth = depth;
        refused(s, "--max-depth");
    }
    for (const double least : {-1e-9, nan, infinity}) {
        s = everything();
        s.tracing.min_contribution = least;
        refused(s, "--min-contribution");
    }
    s = everything();
    s.focus_m.reset();
    refused(s, "--focus");
    s = everything();
    s.f_number = 0;
    refused(s, "f-number");
    s = everything();
    s.focus_m = 0;
    refused(s, "focus distance");
    s = everything();
    s.time_s = nan;
    refused(s, "--time");
}

TEST(RenderErrors, AnInterruptionBeforeItBeginsWritesNothing) {
    const TemporaryFolder folder;
    Job job;
    const JobScope scope(job);
    job.cancel();
    EXPECT_THROW((void)render_to_file(busy_scene().scene, everything(), folder.path() / "x.exr"), Error);
    EXPECT_FALSE(fs::exists(folder.path() / "x.exr"));
}

}  // namespace
}  // namespace postlens::test::render_test
