// Published glTF, OBJ and PLY files: what they hold is read, and broken ones are refused.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <iostream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "tests/scene/mesh_text.h"
#include "tests/scene/read_apart.h"
#include "tests/support/file_bytes.h"
#include "tracer/camera_model.h"

namespace postlens::test::mesh_scene_test {
namespace {

namespace fs = std::filesystem;
using glm::dvec3;

const fs::path published = fs::path(POSTLENS_TEST_DATA) / "mesh";
const fs::path shared_data = fs::path(POSTLENS_SHARED_DATA);

std::vector<fs::path> scenes_below(const fs::path& folder) {
    std::vector<fs::path> out;
    if (!fs::exists(folder)) return out;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (is_scene_file(entry.path())) out.push_back(entry.path());
    }
    std::sort(out.begin(), out.end());
    return out;
}

TEST(PublishedMeshes, LoadOrAreRefusedInOneLine) {
    // Files without visible content, and invalid files.
    const std::set<std::string> refused{"invalid-face-definition.obj", "invalid-relative-vertex-index.obj",
                                        "BoxWithInfinites.glb",        "RecursiveNodes.gltf",
                                        "IndexOutOfRange.gltf",        "badArray.gltf"};
    auto files = scenes_below(published);
    EXPECT_GE(files.size(), 12U);
    for (const char* folder : {"gltf", "mesh"}) {
        const auto more = scenes_below(shared_data / folder);
        if (more.empty()) std::cout << "no ../shared/data/" << folder << ": only the copies are read\n";
        files.insert(files.end(), more.begin(), more.end());
    }
    for (const fs::path& file : files) {
        const ReadOutcome o = read_apart(file);
        EXPECT_TRUE(refused.contains(file.filename()) ? o.refused : o.loaded) << file << ": " << o.text;
    }
}

TEST(PublishedMeshes, BrokenOnesAreRefusedWithinTimeAndMemory) {
    const auto files = scenes_below(shared_data / "gltf-broken");
    if (files.empty()) GTEST_SKIP() << "no ../shared/data/gltf-broken";
    for (const fs::path& file : files) {
        const ReadOutcome o = read_apart(file);
        EXPECT_TRUE(o.refused) << file << ": " << o.text;
    }
}

TEST(PublishedMeshes, SimpleMeshesShareTheirTriangles) {
    const Scene s = read_scene(published / "SimpleMeshes.gltf");
    ASSERT_EQ(s.objects.size(), 2U);
    EXPECT_EQ(&mesh_of(s.objects[0]), &mesh_of(s.objects[1]));
    EXPECT_NE(s.objects[0].id, s.objects[1].id);
    EXPECT_EQ(moved(s.objects[1], 0, {0, 1, 0}), dvec3(1, 1, 0));
    ASSERT_EQ(mesh_of(s.objects[0]).normals.size(), 3U);
    EXPECT_EQ(mesh_of(s.objects[0]).normals[2], glm::vec3(0, 0, 1));
}

TEST(PublishedMeshes, CamerasAreThoseOfTheFile) {
    const Scene s = read_scene(published / "Cameras.gltf");
    ASSERT_EQ(s.cameras.size(), 2U);
    const Camera &p = s.cameras[0], &o = s.cameras[1];
    EXPECT_EQ(p.projection, Camera::Projection::perspective);
    EXPECT_NEAR(*p.vertical_fov_degrees, 0.7 * 180 / std::numbers::pi, 1e-12);
    EXPECT_EQ(p.width, p.height);
    EXPECT_EQ(p.position, dvec3(0.5, 0.5, 3));
    EXPECT_EQ(p.look_at, dvec3(0.5, 0.5, 2));
    EXPECT_EQ(o.projection, Camera::Projection::orthographic);
    EXPECT_EQ(o.orthographic_width_m, 2);
    EXPECT_NE(p.name, o.name);
    // A point at yfov / 2 above the axis of the perspective camera is at the upper border of its film.
    const CameraModel model(p, 0);
    const auto at = model.place(p.position + dvec3(0, std::tan(0.35), -1));
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->y, 0, 1e-9);
}

TEST(PublishedMeshes, AHierarchyPlacesItsChildren) {
    const Scene s = read_scene(published / "02_node_hierarchy.gltf");
    ASSERT_EQ(s.objects.size(), 2U);
    EXPECT_EQ(s.objects[0].name, "Cube");
    EXPECT_EQ(s.objects[1].name, "Flat_Sphere");
    EXPECT_EQ(moved(s.objects[1], 0, dvec3(0)), dvec3(4, 4, 0));
    EXPECT_TRUE(notes_have(s, "no camera"));
}

TEST(PublishedMeshes, TheAnimatedCubeTurnsAsItsKeysSay) {
    const fs::path file = shared_data / "gltf/AnimatedCube/AnimatedCube.gltf";
    if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
    const Scene s = read_scene(file);
    ASSERT_EQ(s.objects.size(), 1U);
    const Object& cube = s.objects[0];
    ASSERT_FALSE(cube.keys.empty());
    // The keys at 0, 1 and 2 s are (0, 0, 0, 1), (0, 1, 0, -4e-8) and (0, -9e-8, 0, -1). The dot products of
    // neighbours are slightly below 0, so the shorter arc runs backwards: half a turn per second about -y.
    // The keys have errors of 4e-8, which moves a corner at sqrt(3) m by 2 sqrt(3) times as much.
    for (int i = 0; i <= 200; ++i) {
        const double t = 2 * i / 200.0, a = -std::numbers::pi * t;
        const dvec3 corner(1, 1, 1);
        const dvec3 wanted(std::cos(a) + std::sin(a), 1, std::cos(a) - std::sin(a));
        EXPECT_LT(glm::length(moved(cube, t, corner) - wanted), 4e-7) << t;
    }
    EXPECT_TRUE(s.materials[cube.material].colour_texture);
    EXPECT_EQ(s.materials[cube.material].name, "AnimatedCube");
}

// The cubic spline of [gltf2, appendix C.4], for values v_k with tangents a_k in and b_k out.
double hermite(double v0, double b0, double v1, double a1, double gap, double t) {
    return (2 * t * t * t - 3 * t * t + 1) * v0 + gap * (t * t * t - 2 * t * t + t) * b0 +
           (-2 * t * t * t + 3 * t * t) * v1 + gap * (t * t * t - t * t) * a1;
}

TEST(PublishedMeshes, ACubicSplineIsFollowed) {
    const Scene s = read_scene(published / "01_cs_translate.gltf");
    ASSERT_EQ(s.objects.size(), 1U);
    const Object& cube = s.objects[0];
    // The file has 9 vectors: values (0,0,0), (2,1,0) and (0,0,0) at 0, 1 and 2 s, each with two tangents.
    const std::string bytes = bytes_of(published / "01_cs_translate.bin");
    std::vector<float> v(27);
    std::memcpy(v.data(), bytes.data() + 624, 108);
    EXPECT_EQ(v[12], 2.0F);
    const double size = 2 * std::sqrt(3.0);  // of the cube
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
        const double t = 2 * i / 1000.0;
        const int k = std::min(static_cast<int>(t), 1);
        dvec3 wanted;
        for (int c = 0; c < 3; ++c) {
            const auto at = [&](int key, int part) {
                return static_cast<double>(v[static_cast<std::size_t>(9 * key + 3 * part + c)]);
            };
            wanted[c] = hermite(at(k, 1), at(k, 2), at(k + 1, 1), at(k + 1, 0), 1, t - k);
        }
        worst = std::max(worst, glm::length(moved(cube, t, dvec3(0)) - wanted));
    }
    // The tolerance is 1/10000 of the size at seven instants in every gap. Between these, the error of a
    // chord of a parabola is at most 1 / 0.9375 times that at the nearest instant.
    EXPECT_LT(worst, 1e-4 * size / 0.93);
    EXPECT_GT(cube.keys.size(), 8U);
}

TEST(PublishedMeshes, PolygonsAndColoursOfObjAndPly) {
    EXPECT_EQ(triangles(read_scene(published / "cube_binary.ply")), 12U);
    const Scene uv = read_scene(published / "cube_uv.ply");
    EXPECT_EQ(triangles(uv), 12U);
    EXPECT_EQ(mesh_of(uv.objects.at(0)).uvs.size(), 24U);
    EXPECT_EQ(triangles(read_scene(published / "concave_polygon.obj")), 64U);  // of 66 corners
    EXPECT_EQ(triangles(read_scene(published / "box_UTF16BE.obj")), 12U);
    const Scene colours = read_scene(published / "cube-vertexcol.obj");
    EXPECT_EQ(colours.objects.size(), 6U);
    EXPECT_EQ(mesh_of(colours.objects[0]).colours.at(2), glm::vec3(0, 1, 0));
    EXPECT_TRUE(notes_have(colours, "'cube.mtl' cannot be read"));
}

TEST(PublishedMeshes, CornersThatAreNotFiniteCostTheirFacesOnly) {
    const Scene s = read_scene(published / "test-nan.obj");
    EXPECT_TRUE(notes_have(s, "a corner that is not finite"));
    const Scene whole = read_scene(published / "cornell_box.obj");
    EXPECT_EQ(triangles(s) + 2, triangles(whole));
    for (const Object& o : s.objects) {
        for (const glm::vec3& p : mesh_of(o).positions) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
    }
}

TEST(PublishedMeshes, TheCornellBoxIsSeenFromItsOpenSide) {
    const Scene s = read_scene(published / "cornell_box.obj", {.metres_per_unit = 0.001});
    std::set<std::string> names;
    for (const Object& o : s.objects) names.insert(o.name);
    EXPECT_TRUE(names.contains("floor") && names.contains("tall_block"));
    const CameraModel camera(s.cameras.at(0), 0);
    EXPECT_LT(camera.position.z, -0.5);  // the back wall is at 0.559 m
    EXPECT_GT(camera.forward.z, 0.99);
    for (const Object& o : s.objects) {
        for (const glm::vec3& p : mesh_of(o).positions) {
            const auto at = camera.place(dvec3(p));
            ASSERT_TRUE(at);
            EXPECT_TRUE(at->x > 0 && at->x < camera.width && at->y > 0 && at->y < camera.height);
        }
    }
    // The light's Ka of 20 has a radiance of 2 under the ambient light of 0.1.
    for (const Object& o : s.objects) {
        if (o.name != "light") continue;
        EXPECT_NEAR((s.materials[o.material].ambient * s.ambient_light).x, 2, 1e-6);
    }
}

}  // namespace
}  // namespace postlens::test::mesh_scene_test
