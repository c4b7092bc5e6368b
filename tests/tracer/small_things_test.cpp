// Objects narrower than the distance of two corners are found, and their light is correct.
#include "tracer/recording/small_things.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_file.h"
#include "tests/support/quads.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/trace.h"

namespace postlens::test::small_things_test {
namespace {

namespace fs = std::filesystem;
using glm::dvec2;
using glm::dvec3;

constexpr int width = 64, height = 48;
constexpr double depth_m = 10, pixel_m = 36.0 / width / 50 * depth_m;  // width of a pixel at that depth

// The point at depth_m that the camera sees at raster position `px`.
dvec3 point_at(const dvec2& px) {
    return {(px.x - width / 2.0) * pixel_m, -(px.y - height / 2.0) * pixel_m, -depth_m};
}

SmallThings things_of(const Scene& scene) {
    return {scene, ObjectParts(scene), CameraModel(scene.cameras[0], scene.time_s), scene.time_s, 0, width, 0,
            height};
}

struct Sampled {
    RayCounts counts;
    std::vector<double> light;          // per pixel
    std::map<std::uint32_t, int> hits;  // number of point samples per object id
};
Sampled sample(const Scene& scene, const SmallThings& things, int levels = 2) {
    const RayScene rays(scene, scene.time_s);
    const CameraModel camera(scene.cameras[0], scene.time_s);
    const WhittedTracer tracer(rays, camera, {});
    RecordBand all;
    all.x_begin = 0;
    all.x_end = width + 1;
    all.y_end = 0;
    Sampled out;
    const SubdivisionSettings settings{.levels = std::max(levels, things.levels()), .edge_levels = levels};
    out.counts = sample_corners(
        tracer, {0, width, 0, height}, settings,
        [&](const RecordBand& band) {
            const auto before = static_cast<std::uint32_t>(all.records.size());
            if (all.offsets.empty()) all.offsets.push_back(0);
            for (std::size_t i = 1; i < band.offsets.size(); ++i)
                all.offsets.push_back(before + band.offsets[i]);
            all.records.insert(all.records.end(), band.records.begin(), band.records.end());
            all.y_end = band.y_end;
        },
        things);
    for (const Record& r : all.records) ++out.hits[r.id];
    std::vector<float> rgb(3 * width);
    for (int y = 0; y < height; ++y) {
        picture_row(all, y, 0, width, rgb);
        for (std::size_t x = 0; x < width; ++x) out.light.push_back(static_cast<double>(rgb[3 * x]));
    }
    return out;
}

double sum(const std::vector<double>& v) {
    double out = 0;
    for (const double x : v) out += x;
    return out;
}

/// A square of 8 x 8 px of the raster contains one light with a radiance of 20. Tests that `found` contains
/// all of them, each as bright as `expected`, and that `missed` lacks some. Cells have at most `levels`
/// levels. Returns the mean of the ratios of the light to the expected one.
double expect_lights(const Sampled& found, const Sampled& missed, const std::vector<double>& expected,
                     int levels) {
    int lacks = 0;
    double mean = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const auto id = static_cast<std::uint32_t>(i + 1);
        lacks += missed.hits.contains(id) ? 0 : 1;
        EXPECT_TRUE(found.hits.contains(id)) << i;
        double light = 0;
        for (std::size_t y = 0; y < 8; ++y) {
            for (std::size_t x = 0; x < 8; ++x) light += found.light[(i / 8 * 8 + y) * width + i % 8 * 8 + x];
        }
        // The number of lattice points in a circle with a radius of R cells has a variance of 0.6765 R
        // [kendall1948]. R is at least 8, unless the deepest level limits it.
        const double diameter_px = std::sqrt(expected[i] / 20 * 4 / std::numbers::pi);
        const double cells = std::min(diameter_px / 2 * (1 << levels), 8.0);
        const double deviation = std::sqrt(0.6765 * cells) / (std::numbers::pi * cells * cells);
        EXPECT_NEAR(light / expected[i], 1, 4 * deviation) << i << ", " << diameter_px << " px";
        mean += light / expected[i] / static_cast<double>(expected.size());
    }
    EXPECT_GT(lacks, 5);  // otherwise the scene tests nothing
    return mean;
}

TEST(SmallThings, EveryLampIsFoundAndAsBrightAsItsAreaSays) {
    // Each block of 8 x 8 px has one light of 0.2 to 1.4 px width, at a random position within 5 px.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(1.5, 6.5), wide(0.2, 1.4);
    SceneBuilder b;
    std::vector<double> expected;
    for (int by = 0; by < height / 8; ++by) {
        for (int bx = 0; bx < width / 8; ++bx) {
            const dvec3 at = point_at({8 * bx + place(random), 8 * by + place(random)});
            const double diameter_px = wide(random);
            b.add(Sphere{at, diameter_px / 2 * pixel_m}, glowing(dvec3(20)));
            // A small sphere off the axis is an ellipse on the film, whose area is larger by 1 / cosine of
            // the angle.
            expected.push_back(20 * std::numbers::pi / 4 * diameter_px * diameter_px * glm::length(at) /
                               depth_m);
        }
    }
    const double mean = expect_lights(sample(b.scene, things_of(b.scene)), sample(b.scene, {}), expected,
                                      SmallThings::most_levels);
    EXPECT_NEAR(mean, 1, 0.007);  // four standard deviations of the mean of 48
}

TEST(SmallThings, AHairOfAFifthOfAPixelCoversWhatItShould) {
    SceneBuilder b;
    const dvec3 from = point_at({-4, 7.3}), to = point_at({width + 4.0, 37.9});
    b.add(Cone{from, to, 0.1 * pixel_m, 0.1 * pixel_m}, glowing(dvec3(1)));
    const Sampled s = sample(b.scene, things_of(b.scene));
    // Each column of pixels has the same length of the hair, seen slightly obliquely towards the sides.
    const dvec2 slope(width + 8, 37.9 - 7.3);
    const double across = 0.2 * glm::length(slope) / slope.x * width;
    EXPECT_NEAR(sum(s.light) / across, 1, 0.02);
    for (std::size_t x = 0; x < width; ++x) {
        double column = 0;
        for (std::size_t y = 0; y < height; ++y) column += s.light[y * width + x];
        EXPECT_GT(column, 0.1) << x;
    }
}

// Away from the centre of the film, the line of sight determines the projected width, not the optical axis.
TEST(SmallThings, ADiscSeenFromItsEdgeCoversWhatItShould) {
    SceneBuilder b;
    const dvec3 centre = point_at({52.3, 37.8}), sight = glm::normalize(centre),
                beside = glm::normalize(glm::cross(sight, dvec3(0.3, 1, 0))),
                normal = glm::normalize(beside + 0.01 * sight), u = glm::normalize(glm::cross(normal, sight)),
                v = glm::cross(normal, u);
    const double radius = 8 * pixel_m;
    b.add(Disc{centre, normal, radius}, glowing(dvec3(1)));
    const CameraModel camera(b.scene.cameras[0], b.scene.time_s);
    double area = 0;
    constexpr int corners = 1000;
    const auto corner = [&](int i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        return camera.place(centre + radius * (std::cos(angle) * u + std::sin(angle) * v)).value();
    };
    for (int i = 0; i < corners; ++i) {
        const auto p = corner(i), q = corner(i + 1);
        area += (p.x * q.y - p.y * q.x) / 2;
    }
    area = std::abs(area);
    EXPECT_NEAR(area, std::numbers::pi * 8 * 0.08, 0.3);
    const Sampled s = sample(b.scene, things_of(b.scene));
    EXPECT_NEAR(sum(s.light) / area, 1, 0.03);
}

TEST(SmallThings, AConeIsFoundToItsTip) {
    SceneBuilder b;
    const dvec2 base(-4, 41.2), apex(60.2, 7.7);
    b.add(Cone{point_at(base), point_at(apex), 0.7 * pixel_m, 0}, glowing(dvec3(1)));
    const Sampled s = sample(b.scene, things_of(b.scene));
    const dvec2 along = apex - base;
    // Sums the last 16 columns before the tip.
    double light = 0;
    for (std::size_t x = 44; x < 60; ++x) {
        double column = 0;
        for (std::size_t y = 0; y < height; ++y) column += s.light[y * width + x];
        light += column;
        const double wide =
            1.4 * (apex.x - (static_cast<double>(x) + 0.5)) / along.x * glm::length(along) / along.x;
        EXPECT_GT(column, wide / 2) << x;
    }
    const auto of_triangle = [&](double length) {
        return 0.7 * length * length / along.x * glm::length(along) / along.x;
    };
    EXPECT_NEAR(light / (of_triangle(apex.x - 44) - of_triangle(apex.x - 60)), 1, 0.05);
}

// A cone 40 px wide at its base. Its last 2.5 px lie between two rows of corners.
// The cone points down, because a trace follows a narrow object along a row even without SmallThings.
TEST(SmallThings, AWideConeIsFoundToItsTip) {
    SceneBuilder b;
    const double tip = 40.8;
    b.add(Cone{point_at({20.5, tip - 100}), point_at({20.5, tip}), 20 * pixel_m, 0}, glowing(dvec3(1)));
    const auto rows = [&](const SmallThings& things) {
        const Sampled s = sample(b.scene, things);
        return std::array{s.light[39 * width + 20], s.light[40 * width + 20]};
    };
    EXPECT_EQ(rows({})[1], 0);
    const auto [before, last] = rows(things_of(b.scene));
    // Of two triangles, both 0.2 px wide on either side of the axis for each px of length.
    EXPECT_NEAR(before, 0.2 * (1.8 * 1.8 - 0.8 * 0.8), 0.03);
    EXPECT_NEAR(last, 0.2 * 0.8 * 0.8, 0.03);
}

TEST(SmallThings, WhatStandsBehindAWallCostsNothing) {
    SceneBuilder b;
    b.add(square(point_at({32, 24}) + dvec3(0, 0, 2), {0, 0, 1}, 100), matte(dvec3(0.5)));
    const std::uint64_t bare = sample(b.scene, {}).counts.eye;
    for (int i = 0; i < 20; ++i)
        b.add(Sphere{point_at({3.0 * i + 2.2, 20.3}), 0.3 * pixel_m}, glowing(dvec3(20)));
    const SmallThings things = things_of(b.scene);
    EXPECT_FALSE(things.empty());
    EXPECT_EQ(sample(b.scene, things).counts.eye, bare);
}

TEST(SmallThings, OfTooManyTheBrightAndTheWiderComeFirst) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(0, width), y(0, height), wide(0.05, 0.2);
    SceneBuilder b;
    for (int i = 0; i < 3000; ++i)
        b.add(Sphere{point_at({x(random), y(random)}), wide(random) * pixel_m}, matte(dvec3(0.5)));
    b.add(Sphere{point_at({20.3, 20.6}), 0.05 * pixel_m}, glowing(dvec3(50)));
    const SmallThings things = things_of(b.scene);
    EXPECT_GT(things.lost(), 1000U);
    const Sampled s = sample(b.scene, things);
    EXPECT_TRUE(s.hits.contains(3001));
    // A split needs at most five corners, and there are 4/3 splits per smallest divided cell.
    EXPECT_LT(static_cast<double>(s.counts.eye),
              (1 + 5 * 4.0 / 3 * SmallThings::most_cells_per_pixel) * (width + 1) * (height + 1));
}

TEST(SmallThings, BoxesDiscsAndMeshesAreFoundToo) {
    SceneBuilder b;
    const dvec3 half(0.12 * pixel_m, 0.12 * pixel_m, 0.12 * pixel_m);
    b.add(Box{point_at({10.4, 10.4}) - half, point_at({10.4, 10.4}) + half}, glowing(dvec3(1)));
    b.add(Disc{point_at({20.4, 10.4}), {0, 0, 1}, 0.15 * pixel_m}, glowing(dvec3(1)));
    b.add(square(point_at({30.4, 10.4}), {0, 0, 1}, 0.3 * pixel_m), glowing(dvec3(1)));
    b.add(sphere_mesh(8, 8, false), glowing(dvec3(1)),
          glm::translate(glm::dmat4(1), point_at({40.4, 10.4})) *
              glm::scale(glm::dmat4(1), dvec3(0.15 * pixel_m)));
    const Sampled s = sample(b.scene, things_of(b.scene));
    for (const std::uint32_t id : {1U, 2U, 3U, 4U}) EXPECT_TRUE(s.hits.contains(id)) << id;
    EXPECT_EQ(sample(b.scene, {}).hits.size(), 1U);  // none of them is hit by chance
}

/// Quads of half a pixel, far apart and turned in all directions.
std::vector<Quad> leaves() {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    const auto direction = [&] {
        return glm::normalize(dvec3(normal(random), normal(random), normal(random)));
    };
    std::vector<Quad> out;
    for (int y = 2; y < height; y += 5) {
        for (int x = 2; x < width; x += 5) {
            const dvec3 at = point_at({x + 0.4, y + 0.3}), u = direction() * 0.25 * pixel_m,
                        v = glm::normalize(glm::cross(u, direction())) * 0.1 * pixel_m;
            out.push_back({at - u, at - v, at + u, at + v});
        }
    }
    return out;
}

TEST(SmallThings, ThePartsOfAMeshAreFoundLikeObjects) {
    SceneBuilder together, apart;
    together.add(mesh_of(leaves()), glowing(dvec3(1)));
    for (const Quad& quad : leaves()) apart.add(mesh_of({quad}), glowing(dvec3(1)));
    const Sampled a = sample(together.scene, things_of(together.scene)),
                  b = sample(apart.scene, things_of(apart.scene));
    EXPECT_EQ(a.counts.eye, b.counts.eye);
    EXPECT_EQ(a.light, b.light);
    // Nearly edge-on ones are narrower than 1/128 px, and may be missed.
    EXPECT_GT(b.hits.size(), 0.95 * static_cast<double>(leaves().size()));
    EXPECT_LT(sample(apart.scene, {}).hits.size(), 0.2 * static_cast<double>(leaves().size()));
}

// More parts than pieces are kept while a mesh is read: the widest, which come last, are among those.
TEST(SmallThings, OfManyThousandPartsTheWiderComeFirst) {
    const auto quad = [](const dvec2& at, double width_px) {
        const double half = width_px / 2;
        return Quad{point_at(at + dvec2(-half, -half)), point_at(at + dvec2(half, -half)),
                    point_at(at + dvec2(half, half)), point_at(at + dvec2(-half, half))};
    };
    std::vector<Quad> quads;
    for (int i = 0; i < 90000; ++i)
        quads.push_back(quad({0.2 * (i % 300) + 0.1, 0.15 * (i / 300) + 0.1}, 0.03));
    for (int i = 0; i < 10; ++i) quads.push_back(quad({6.0 * i + 3, 47}, 0.5));
    SceneBuilder b;
    b.add(mesh_of(quads), glowing(dvec3(1)));
    const SmallThings things = things_of(b.scene);
    EXPECT_LE(things.cells(), SmallThings::most_cells_per_pixel * width * height);
    EXPECT_GT(things.cells(), 0.9 * SmallThings::most_cells_per_pixel * width * height);
    EXPECT_EQ(things.lost(), 1U);
    for (int i = 0; i < 10; ++i)
        EXPECT_TRUE(things.wanted(6.0 * i + 2.5, 46.5, 1, INFINITY).divide(1, false)) << i;
}

TEST(SmallThings, AMeshIsAsNarrowAsItLooksInAnyDirection) {
    // Ribbons of 10 px by 0.2 px, whose boxes along the coordinate axes are wide.
    for (const double angle : {0.3, 0.8, 1.2}) {
        const dvec3 along(std::cos(angle), std::sin(angle), 0), aside(-along.y, along.x, 0);
        const dvec3 at = point_at({30.3, 20.6}), u = along * 5.0 * pixel_m, v = aside * 0.1 * pixel_m;
        SceneBuilder b;
        b.add(mesh_of({{at - u - v, at + u - v, at + u + v, at - u + v}}), glowing(dvec3(1)));
        const Sampled s = sample(b.scene, things_of(b.scene));
        double light = 0;
        for (const double pixel : s.light) light += pixel;
        EXPECT_NEAR(light, 10 * 0.2, 0.1 * 10 * 0.2) << angle;
    }
}

TEST(SmallThings, WideAndInfiniteThingsAskForNothing) {
    SceneBuilder b;
    b.add(Sphere{point_at({20, 20}), 3 * pixel_m}, glowing(dvec3(20)));
    b.add(Plane{{0, -1, 0}, {0, 1, 0}}, matte(dvec3(0.5)));
    b.add(Sphere{{0, 0, 5}, 1e-3}, glowing(dvec3(20)));  // behind the camera
    b.add(Sphere{point_at({-300, 20}), 0.2 * pixel_m}, glowing(dvec3(20)));
    const SmallThings things = things_of(b.scene);
    EXPECT_TRUE(things.empty());
    EXPECT_EQ(things.levels(), 0);
    EXPECT_EQ(things.lost(), 0U);
}

TEST(SmallThings, AreSoughtWhereTheyAreAtEachInstantOfAFile) {
    SceneBuilder b;
    Object& lamp = b.add(Sphere{{0, 0, 0}, 0.15 * pixel_m}, glowing(dvec3(20)));
    lamp.motion_base = glm::dmat4(1);
    lamp.keys = {{.time_s = 0, .translation = point_at({10.4, 20.4})},
                 {.time_s = 1, .translation = point_at({50.4, 20.4})}};
    lamp.world_from_object = transform_at(lamp.keys, 0);
    const TemporaryFolder folder;
    TraceSettings settings;
    settings.for_shutter = TimeSpan{0, 1};
    settings.keys = 3;
    settings.hidden_layers = 0;
    const TraceResult r = trace_to_file(b.scene, settings, folder.path() / "lamp.exr");
    EXPECT_EQ(r.too_narrow_objects, 0U);
    const SampleFileReader file(folder.path() / "lamp.exr");
    EXPECT_EQ(file.header().subdivide_levels, 6);
    RecordBand band;
    for (std::size_t k = 0; k < file.instants(); ++k) {
        int hits = 0;
        double place = 0;
        for (int y = file.y_begin(); y < file.y_end(); ++y) {
            file.read(y, y + 1, band, k);
            for (const Record& record : band.records) {
                hits += record.id == 1 ? 1 : 0;
                place += record.id == 1 ? static_cast<double>(record.x) : 0;
            }
        }
        ASSERT_GT(hits, 20) << k;
        EXPECT_NEAR(place / hits, 10.4 + 40 * file.instant_s(k), 0.15) << k;
    }
}

TEST(SmallThings, OnlyTheyAreDividedFiner) {
    // The contrast of stripes needs all levels of colours. A light far from them needs more levels, which
    // must not apply to the stripes.
    SceneBuilder b;
    for (int i = 0; i < 8; ++i) {
        b.add(square(point_at({8 + 2.3 * i, 10}), {0, 0, 1}, 1.9 * pixel_m),
              glowing(dvec3(i % 2 == 0 ? 0.9 : 0.1)));
        b.scene.objects.back().id = 1;
    }
    const auto hits_of_stripes = [&](const fs::path& path) {
        TraceSettings settings;
        settings.subdivision.levels = 1;
        (void)trace_to_file(b.scene, settings, path);
        const SampleFileReader file(path);
        RecordBand band;
        file.read(file.y_begin(), file.y_end(), band);
        return std::count_if(band.records.begin(), band.records.end(),
                             [](const Record& r) { return r.id == 1; });
    };
    const TemporaryFolder folder;
    const auto alone = hits_of_stripes(folder.path() / "stripes.exr");
    b.add(Sphere{point_at({50.4, 40.4}), 0.1 * pixel_m}, glowing(dvec3(20)));
    EXPECT_EQ(hits_of_stripes(folder.path() / "lamp.exr"), alone);
}

TEST(SmallThings, AFileWithoutSubdivisionStaysWithoutIt) {
    SceneBuilder b;
    b.add(Sphere{point_at({20.4, 20.4}), 0.15 * pixel_m}, glowing(dvec3(20)));
    const TemporaryFolder folder;
    TraceSettings settings;
    settings.subdivision.levels = 0;
    const TraceResult r = trace_to_file(b.scene, settings, folder.path() / "bare.exr");
    EXPECT_EQ(r.rays.eye, (width + 1U) * (height + 1U));
    EXPECT_EQ(r.too_narrow_objects, 1U);  // reported by the command
}

TEST(BrightImages, EveryLampInAFlatMirrorIsFoundAndAsBrightAsItsAreaSays) {
    // The mirror halves the distance depth_m, so the images of these lights are those of the test above.
    std::mt19937 random(8);
    std::uniform_real_distribution<double> place(1.5, 6.5), wide(0.2, 1.4);
    SceneBuilder b;
    std::vector<double> expected;
    for (int by = 0; by < 3; ++by) {  // more would exceed the limit of cells
        for (int bx = 0; bx < width / 8; ++bx) {
            const dvec3 image = point_at({8 * bx + place(random), 8 * by + place(random)});
            const double diameter_px = wide(random);
            b.add(Sphere{{image.x, image.y, 0}, diameter_px / 2 * pixel_m}, glowing(dvec3(20)));
            expected.push_back(20 * std::numbers::pi / 4 * diameter_px * diameter_px * glm::length(image) /
                               depth_m);
        }
    }
    b.add(Plane{{0, 0, -depth_m / 2}, {0, 0, 1}}, mirror());
    (void)expect_lights(sample(b.scene, things_of(b.scene)), sample(b.scene, {}), expected,
                        BrightImages::most_levels);
}

TEST(BrightImages, LampsInAMirrorBallAndInGlassAreAsBrightAsManyPointsShowThem) {
    for (const Material& material : {mirror(), glass(1.5)}) {
        SceneBuilder b;
        for (int i = 0; i < 24; ++i) {
            // Even ones are behind the camera, odd ones behind the ball.
            const double angle = 0.2618 * i;
            const bool even = i % 2 == 0;
            b.add(Sphere{dvec3(1.5 * std::cos(angle), 1.5 * std::sin(angle), even ? 3 : -14),
                         even ? 0.25 : 0.05},
                  glowing(dvec3(20)));
        }
        b.add(Sphere{{0, 0, -6}, 1}, material);
        const SmallThings things = things_of(b.scene);
        ASSERT_FALSE(things.images().empty());
        const double light = sum(sample(b.scene, things).light), without = sum(sample(b.scene, {}).light);
        const RayScene rays(b.scene, 0);
        const CameraModel camera(b.scene.cameras[0], 0);
        const WhittedTracer tracer(rays, camera, {});
        constexpr int fine = 24;
        double expected = 0;
        std::vector<dvec2> row(static_cast<std::size_t>(width * fine));
        TracedSamples traced;
        RayCounts counts;
        for (int y = 0; y < height * fine; ++y) {
            for (std::size_t x = 0; x < row.size(); ++x) row[x] = (dvec2(x, y) + 0.5) / dvec2(fine);
            tracer.trace(row, traced, counts);
            for (const Record& r : traced.records) expected += static_cast<double>(r.r) / (fine * fine);
        }
        // The images have radii of 5 lattice cells and more. The mean of 12 of them has a standard deviation
        // of at most 0.8 % by cells and by points.
        EXPECT_NEAR(light / expected, 1, 0.04) << material.ior << " " << without / expected;
        EXPECT_GT(std::abs(without / expected - 1), 0.06);
    }
}

TEST(BrightImages, ASceneWithoutMirrorsHasNone) {
    SceneBuilder b;
    b.add(Sphere{point_at({20, 20}), 0.1}, glowing(dvec3(20)));
    EXPECT_TRUE(things_of(b.scene).images().empty());
    b.add(Plane{{0, 0, -depth_m}, {0, 0, 1}}, mirror());
    EXPECT_FALSE(things_of(b.scene).images().empty());
}

TEST(BrightImages, TooManyLampsAreLimitedByTheRaster) {
    // With more mirrors, fewer light sources fit into the number of cells that the raster allows.
    SceneBuilder b;
    for (int i = 0; i < 100; ++i) b.add(Sphere{{0.1 * i, 0, -20}, 0.001 * (i + 1)}, glowing(dvec3(2)));
    for (int i = 0; i < 1000; ++i) b.add(Sphere{{0, 0, 1.0 + i}, 0.1}, mirror());
    const double most = SmallThings::most_cells_per_pixel * width * height;
    ASSERT_LT(most, BrightImages::cells_of_image * 2 * 1000);
    EXPECT_TRUE(things_of(b.scene).images().empty());
}

}  // namespace
}  // namespace postlens::test::small_things_test
