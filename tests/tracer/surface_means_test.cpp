// Records of rough surfaces and of surfaces under lights with an extent hold means over lobes and lights.
// These are compared with closed forms and with `render`. Also tests reflection by angle.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/threads.h"
#include "focus/focus.h"
#include "pictures/srgb.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/motion_frame.h"
#include "tests/support/reference.h"
#include "tests/support/scene_builder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/render.h"
#include "tracer/shading/light_means.h"
#include "tracer/shading/shading.h"
#include "tracer/shading_trees/lobe_means.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test::surface_means_test {
namespace {

using glm::dvec2;
using glm::dvec3;

const std::filesystem::path scenes = std::filesystem::path(POSTLENS_STABILITY) / "scenes";

Scene scene_of_file(const char* name, int width, int height) {
    Scene s = read_scene(scenes / name);
    s.cameras[0].width = width;
    s.cameras[0].height = height;
    return s;
}

Material rough(double reflection, double exponent) {
    Material m = mirror(reflection);
    m.reflection_exponent = exponent;
    return m;
}

struct Traced {
    std::vector<Record> records;
    RayCounts counts;
};

Traced traced(const Scene& scene, const WhittedSettings& settings = {}) {
    const RayScene rays(scene, scene.time_s);
    const CameraModel camera(scene.cameras.at(0), scene.time_s);
    const WhittedTracer tracer(rays, camera, settings);
    Traced out;
    out.counts = sample_corners(
        tracer, {0, camera.width, 0, camera.height}, {.levels = 2}, [&](const RecordBand& band) {
            out.records.insert(out.records.end(), band.records.begin(), band.records.end());
        });
    return out;
}

void expect_same_bits(const Scene& scene) {
    std::vector<Record> first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const std::vector<Record> got = traced(scene).records;
        if (first.empty()) first = got;
        EXPECT_EQ(got, first) << threads;
    }
}

// Fresnel ---------------------------------------------------------------------------------------------

Facing facing(bool entering, const dvec3& normal = {0, 0, 1}) {
    return {normal, normal, entering ? 1.0 : -1.0, false};
}
dvec3 towards_surface(double cosine) {
    return {std::sqrt(1 - cosine * cosine), 0, -cosine};
}

TEST(Fresnel, IsSchlicksByTheAngleInTheThinnerMedium) {
    EXPECT_EQ(schlick_weight(1), 0);
    EXPECT_EQ(schlick_weight(0.5), 1.0 / 32);
    EXPECT_EQ(schlick_weight(0), 1);
    Material m = glass(1.5, 0.96);
    m.reflection = dvec3(0.04);
    m.fresnel = true;
    for (const double cosine : {1.0, 0.8, 0.3, 0.01}) {
        const double expected = 0.04 + 0.96 * std::pow(1 - cosine, 5);
        const Continuation outside = continuation(m, facing(true), towards_surface(cosine));
        EXPECT_NEAR(outside.reflected.x, expected, 1e-12);
        EXPECT_NEAR(outside.transmitted.x, 0.96 * (1 - std::pow(1 - cosine, 5)), 1e-12);
        // The reverse path from inside, at the angle by Snell's law, has the same reflectance.
        const double inside = std::sqrt(1 - (1 - cosine * cosine) / (1.5 * 1.5));
        EXPECT_NEAR(continuation(m, facing(false), towards_surface(inside)).reflected.x, expected, 1e-12);
    }
    // Beyond the critical angle, whose cosine is 0.745, all light is reflected.
    const Continuation total = continuation(m, facing(false), towards_surface(0.7));
    EXPECT_FALSE(total.refracts);
    EXPECT_NEAR(total.reflected.x, 1, 1e-12);
}

TEST(Fresnel, ConstantCoefficientsAreTheDefault) {
    Material m = mirror(0.3);
    for (const double cosine : {1.0, 0.2})
        EXPECT_EQ(continuation(m, facing(true), towards_surface(cosine)).reflected, dvec3(0.3));
}

// Lobes -----------------------------------------------------------------------------------------------

TEST(LobeMeans, AreExactWhereAllAroundIsAlike) {
    SceneBuilder b;
    b.scene.background = {0.25, 0.5, 1};
    for (const double exponent : {1.0, 8.0, 300.0}) {
        SceneBuilder of = b;
        of.add(Sphere{{0, 0, -4}, 1}, rough(0.5, exponent));
        for (const Record& r : traced(of.scene).records) {
            const double share = r.id == 0 ? 1 : 0.5;
            EXPECT_NEAR(r.r, share * 0.25, 1e-6);
            EXPECT_NEAR(r.b, share, 1e-6);
            EXPECT_EQ(r.path.depth(), 0);  // there is no record of a reflected node
        }
    }
}

TEST(LobeMeans, NarrowerThanTheLensIsAMirror) {
    EXPECT_TRUE(lobe_is_wide(100, 0.1, 1.1));
    EXPECT_FALSE(lobe_is_wide(100, 0.1, 0.9));
    EXPECT_FALSE(lobe_is_wide(std::numeric_limits<double>::infinity(), 0, 1));
    SceneBuilder b;
    b.scene.background = dvec3(1);
    b.add(square({0, 0, -4}, {0, 0, 1}, 8), rough(0.5, 100));  // lobe of 0.1 rad: a lens of 0.4 m at 4 m
    for (const double radius : {0.3, 0.6}) {
        const Traced t = traced(b.scene, {.lens_radius_m = radius});
        const bool mirrors = std::any_of(t.records.begin(), t.records.end(),
                                         [](const Record& r) { return r.path.depth() > 0; });
        EXPECT_EQ(mirrors, radius > 0.4);
    }
}

Scene floor_that_reflects(double reflection) {
    Scene s = scene_of_file("brushed_floor.toml", 96, 54);
    for (Material& m : s.materials)
        if (m.reflection != dvec3(0)) m.reflection = dvec3(reflection);
    return s;
}

double reflected_rays_per_hit(double reflection) {
    const RayCounts counts = traced(floor_that_reflects(reflection)).counts;
    return static_cast<double>(counts.reflect) / static_cast<double>(counts.eye_hits);
}

// RMS difference of the encoded red channels of the images of a brushed floor by rays over the lobe and by
// records. The product of the differences from independent halves of the rays has no contribution of their
// noise, whose RMS is an eighth of the result.
double rms_of_lobes(const Scene& s) {
    const TracedFrame frame(s);
    const Image image = pinhole_picture(frame.file());
    const Crop floor{0, 45, image.width, image.height - 45};  // below the posts
    RenderSettings r;
    r.spp = 1024;
    r.crop = floor;
    const Reference truth = reference(s, r);
    double sum = 0;
    int count = 0;
    for (int y = floor.y; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x, ++count) {
            const auto off = [&](const Image& half) {
                return static_cast<double>(srgb_from_linear(image.pixel(x, y)[0])) -
                       static_cast<double>(srgb_from_linear(half.pixel(x, y)[0]));
            };
            sum += off(truth.halves[0]) * off(truth.halves[1]);
        }
    }
    return std::sqrt(sum / count);
}

TEST(LobeMeans, AreThoseOfRenderAndCostRaysByTheirWeight) {
    // A faint lobe has an error of half a step of 8 bits, and 25 % more where the border of a batch cuts off
    // its neighbours. The rays per sample limit a strong one: measured 0.0176.
    EXPECT_LT(rms_of_lobes(floor_that_reflects(0.005)), 1.25 / 510);
    EXPECT_LT(rms_of_lobes(floor_that_reflects(0.75)), 0.02);
    const double of_faint = reflected_rays_per_hit(0.005);
    EXPECT_LT(reflected_rays_per_hit(0.002), of_faint / 2);
    EXPECT_LT(of_faint, reflected_rays_per_hit(0.75) / 1.5);
}

// In the dark, a lobe of little weight shows what is much brighter than white.
TEST(LobeMeans, SeeBrightLightInTheDark) {
    Scene s = floor_that_reflects(0.0005);
    s.lights.clear();
    s.ambient_light = s.background = dvec3(0);
    for (Material& m : s.materials)
        if (m.reflection == dvec3(0)) m.emission = dvec3(20);
    EXPECT_LT(rms_of_lobes(s), 0.006);  // 0.023 with as few rays as for white light
}

TEST(LobeMeans, NoiseDividesNoPixel) {
    Scene s = scene_of_file("brushed_floor.toml", 96, 54);
    for (Object& o : s.objects)
        if (o.name == "floor") o.shape = square({0, -0.3, -3}, {0, 1, 0}, 4);
    Scene bare = s;
    for (Material& m : bare.materials) m.reflection = dvec3(0);
    EXPECT_EQ(traced(s).records.size(), traced(bare).records.size());
}

TEST(LobeMeans, SameBitsForAnyNumberOfThreads) {
    expect_same_bits(scene_of_file("brushed_floor.toml", 96, 54));
}

// Sources with an extent ------------------------------------------------------------------------------

// A floor under a rectangular light, and halfway up a black half-plane whose edge is parallel to a side of
// the light. A floor point x sees the part of the light left of -x.
TEST(LightMeans, OfARectangleBehindAStraightEdgeIsItsVisibleShare) {
    constexpr double side = 0.8, height = 200;
    SceneBuilder b;
    b.add(Plane{{0, 0, 0}, {0, 1, 0}}, matte(dvec3(1)));
    b.add(Rectangle{{0, height / 2, -500}, {0, 0, 1000}, {500, 0, 0}}, matte(dvec3(0)));
    // The light is so high that the cosine is 1 within 1e-5.
    Light& l = b.point_light({0, height, 0}, dvec3(1));
    l.kind = Light::Kind::rectangle;
    l.edge_u = {side, 0, 0};
    l.edge_v = {0, 0, side};
    const RayScene rays(b.scene, 0);
    const PlacedLight placed = place_light(b.scene.lights[0], 0);
    std::vector<ExtentLit> points;
    constexpr int count = 401;
    const auto at = [&](int i) { return dvec3((i - count / 2) * 1.5 * side / count, 0, 0.1); };
    const dvec3 down(0, -1, 0);
    RayBatch buffer;
    for (int i = 0; i < count; ++i) {
        RayBatch ray;
        ray.clear(true);
        ray.add(at(i) + dvec3(0, 1, 0), down, std::numeric_limits<float>::infinity());
        rays.intersect(ray, false);
        ExtentLit p;
        p.light = &placed;
        p.material = &b.scene.materials[0];
        p.key = ray.hit(0);
        p.surface = rays.surface(p.key, at(i) + dvec3(0, 1, 0), down, 1, 0);
        p.facing = face(p.surface, down);
        p.direction = down;
        p.seed = static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15U;
        points.push_back(p);
    }
    std::uint64_t shadow_rays = 0;
    LightMeans(rays).average(points, buffer, shadow_rays);
    double squares = 0, sum = 0;
    int within = 0;
    for (int i = 0; i < count; ++i) {
        const double share = std::clamp((-at(i).x + side / 2) / side, 0.0, 1.0);
        const double got = points[static_cast<std::size_t>(i)].radiance.x;
        // If the light is fully visible or fully hidden, there is no noise.
        if (share == 0 || share == 1) {
            EXPECT_NEAR(got, share, 1e-4) << at(i).x;
            continue;
        }
        // Of k^2 cells the edge crosses a row of k cells, each with an error below 1 / k^2.
        EXPECT_NEAR(got, share, 1.0 / 4) << at(i).x;
        squares += (got - share) * (got - share);
        sum += got - share;
        ++within;
    }
    EXPECT_GT(within, 200);
    EXPECT_LT(std::sqrt(squares / within), 2.0 / 255);
    EXPECT_LT(std::abs(sum / within), 4 * (2.0 / 255) / std::sqrt(within));
}

TEST(LightMeans, TraceAgreesWithRender) {
    Scene s = scene_of_file("soft_shadows.toml", 96, 54);
    for (Material& m : s.materials)
        m.colour_texture = nullptr;  // borders of textures would dominate the error
    const TracedFrame frame(s);
    RenderSettings r;
    r.spp = 1024;
    const Image truth = render_picture(s, r).image;
    EXPECT_GT(encoded_psnr_db(pinhole_picture(frame.file()), truth), 40);
}

TEST(LightMeans, SameBitsForAnyNumberOfThreads) {
    expect_same_bits(scene_of_file("soft_shadows.toml", 64, 36));
}

}  // namespace
}  // namespace postlens::test::surface_means_test
