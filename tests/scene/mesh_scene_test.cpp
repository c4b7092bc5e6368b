// Scenes from glTF, OBJ and PLY: the conversion of all content, and damaged files.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <sys/wait.h>
#include <tuple>

#include "core/error.h"
#include "pictures/image.h"
#include "scene/file_digest.h"
#include "scene/gltf/gltf_animation.h"
#include "scene/mesh/mesh_files.h"
#include "scene/metallic_roughness.h"
#include "scene/placement.h"
#include "scene/sampled_motion.h"
#include "scene/scene.h"
#include "scene/scene_defaults.h"
#include "scene/shape_bounds.h"
#include "tests/scene/gltf_text.h"
#include "tests/support/temporary_folder.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading/shading.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using glm::dmat4;
using glm::dquat;
using glm::dvec3;
using test::GltfText;
using testing::HasSubstr;

const fs::path published = fs::path(POSTLENS_TEST_DATA) / "mesh";
const fs::path shared_data = fs::path(POSTLENS_SHARED_DATA);

const Mesh& mesh_of(const Object& object) {
    return *std::get<std::shared_ptr<const Mesh>>(object.shape);
}

std::size_t triangles(const Scene& scene) {
    std::size_t sum = 0;
    for (const Object& o : scene.objects) sum += mesh_of(o).triangles.size();
    return sum;
}

dmat4 world_at(const Object& o, double t) {
    return o.keys.empty() ? o.world_from_object : transform_at(o.keys, t) * o.motion_base;
}

dvec3 moved(const Object& o, double t, const dvec3& p) {
    return dvec3(world_at(o, t) * glm::dvec4(p, 1));
}

bool notes_have(const Scene& scene, const std::string& text) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

class MeshText : public testing::Test {
  protected:
    fs::path write(const std::string& name, const std::string& bytes) {
        std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
        return folder_.path() / name;
    }
    Scene read(const std::string& name, const std::string& bytes, const SceneReadOptions& options = {}) {
        return read_scene(write(name, bytes), options);
    }
    Scene read(const GltfText& g, const SceneReadOptions& options = {}) {
        return read("t.gltf", g.text(), options);
    }
    // The error message without the file's folder. It must be a single line, with exit code 3.
    std::string error(const std::string& name, const std::string& bytes) {
        try {
            std::ignore = read(name, bytes);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            std::string what = e.what();
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            EXPECT_EQ(what.rfind((folder_.path() / name).string() + ":", 0), 0U) << what;
            return what.substr(folder_.path().string().size() + 1);
        }
        return "no error";
    }
    std::string error(const GltfText& g) { return error("t.gltf", g.text()); }

    test::TemporaryFolder folder_;
};

// The result of reading a file in a separate process, limited to 10 seconds and 1 GiB.
struct Outcome {
    bool loaded = false, refused = false;
    std::string text;  // the error message, or the signal that ended the process
};

Outcome read_apart(const fs::path& path) {
    int pipe_ends[2];
    if (::pipe(pipe_ends) != 0) return {false, false, "no pipe"};
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(pipe_ends[0]);
        ::alarm(10);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        // Sanitizers reserve more address space than that when they start.
        const rlimit limit{rlim_t{1} << 30, rlim_t{1} << 30};
        ::setrlimit(RLIMIT_AS, &limit);
#endif
        int code = 0;
        std::string text;
        try {
            std::ignore = read_scene(path);
        } catch (const Error& e) {
            code = static_cast<int>(e.code());
            text = e.what();
        } catch (const std::exception& e) {
            code = 100;
            text = e.what();
        }
        std::ignore = ::write(pipe_ends[1], text.data(), text.size());
        ::_exit(code);
    }
    ::close(pipe_ends[1]);
    Outcome out;
    char part[512];
    for (ssize_t n = 0; (n = ::read(pipe_ends[0], part, sizeof part)) > 0;) {
        out.text.append(part, static_cast<std::size_t>(n));
    }
    ::close(pipe_ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    out.loaded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    out.refused = WIFEXITED(status) && WEXITSTATUS(status) == 3 && !out.text.empty() &&
                  out.text.find('\n') == std::string::npos;
    if (WIFSIGNALED(status)) out.text = "killed by signal " + std::to_string(WTERMSIG(status));
    return out;
}

std::vector<fs::path> scenes_below(const fs::path& folder) {
    std::vector<fs::path> out;
    if (!fs::exists(folder)) return out;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (is_scene_file(entry.path())) out.push_back(entry.path());
    }
    std::sort(out.begin(), out.end());
    return out;
}

// ---- published files

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
        const Outcome o = read_apart(file);
        EXPECT_TRUE(refused.contains(file.filename()) ? o.refused : o.loaded) << file << ": " << o.text;
    }
}

TEST(PublishedMeshes, BrokenOnesAreRefusedWithinTimeAndMemory) {
    const auto files = scenes_below(shared_data / "gltf-broken");
    if (files.empty()) GTEST_SKIP() << "no ../shared/data/gltf-broken";
    for (const fs::path& file : files) {
        const Outcome o = read_apart(file);
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
    std::ifstream file(published / "01_cs_translate.bin", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
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

// ---- glTF: places and motion

TEST_F(MeshText, ANodesPlaceIsTheProductOfThoseAboveIt) {
    GltfText g;
    g.nodes =
        R"({"children":[1],"translation":[1,2,3],"rotation":[0,0,0.70710678118654752,0.70710678118654752],"scale":[2,2,2]},)"
        R"({"children":[2],"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]},{"mesh":0,"scale":[1,1,-1]})";
    const Scene s = read(g);
    ASSERT_EQ(s.objects.size(), 1U);
    // (1,0,0) is scaled along z, rotated by 90 degrees to (0,1,0), translated by (5,0,0), scaled by 2 to
    // (10,2,0), rotated by 90 degrees to (-2,10,0) and translated by (1,2,3).
    EXPECT_LT(glm::length(moved(s.objects[0], 0, {1, 0, 0}) - dvec3(-1, 12, 3)), 1e-14);
    EXPECT_LT(glm::length(moved(s.objects[0], 0, {0, 0, 1}) - dvec3(1, 12, 1)), 1e-14);
}

TEST_F(MeshText, MotionOfOneAboveAnotherIsTheirProduct) {
    // From the root: a still node with scale 2, a node that moves along x and rotates about z, a translated
    // node, and the node of the mesh, which rotates about y.
    const auto h = static_cast<float>(std::sqrt(0.5));
    GltfText g;
    g.nodes =
        R"({"children":[1],"scale":[2,2,2]},{"children":[2]},{"children":[3],"translation":[1,0,0]},{"mesh":0})";
    g.animate(1, "translation", "LINEAR", {0, 2}, {0, 0, 0, 4, 0, 0});
    g.animate(1, "rotation", "LINEAR", {0, 2}, {0, 0, 0, 1, 0, 0, h, h});
    g.animate(3, "rotation", "LINEAR", {0.5F, 1.5F}, {0, 0, 0, 1, 0, h, 0, h});
    const Scene s = read(g);
    ASSERT_EQ(s.objects.size(), 1U);
    const double size = 2 * std::sqrt(2.0);  // diagonal of the triangle's box, times the scale 2
    double worst = 0;
    for (int i = 0; i <= 300; ++i) {
        const double t = 2.0 * i / 300, quarter = std::numbers::pi / 2;
        const double about_z = quarter * t / 2, about_y = quarter * std::clamp(t - 0.5, 0.0, 1.0);
        for (const dvec3& p : {dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0)}) {
            const dvec3 turned = glm::angleAxis(about_y, dvec3(0, 1, 0)) * p + dvec3(1, 0, 0);
            const dvec3 wanted =
                2.0 * (glm::angleAxis(about_z, dvec3(0, 0, 1)) * turned + dvec3(2 * t, 0, 0));
            worst = std::max(worst, glm::length(moved(s.objects[0], t, p) - wanted));
        }
    }
    EXPECT_LT(worst, 1e-4 * size / 0.93);
    EXPECT_GT(worst, 0);
}

TEST_F(MeshText, LinearMotionOfOneNodeNeedsItsKeysOnly) {
    GltfText g;
    g.nodes = R"({"children":[1],"translation":[0,0,7],"rotation":[1,0,0,0],"scale":[3,3,3]},{"mesh":0})";
    g.animate(1, "translation", "LINEAR", {1, 2, 4}, {0, 0, 0, 1, 0, 0, 1, 5, 0});
    g.animate(1, "scale", "LINEAR", {1, 4}, {1, 1, 1, 4, 1, 1});
    const Scene s = read(g);
    const auto& keys = s.objects.at(0).keys;
    ASSERT_EQ(keys.size(), 3U);
    EXPECT_EQ(keys[0].time_s, 1);
    EXPECT_EQ(keys[2].time_s, 4);
    EXPECT_LT(glm::length(keys[1].scale - dvec3(6, 3, 3)), 1e-14);
    EXPECT_LT(glm::length(moved(s.objects[0], 0, {0, 0, 0}) - dvec3(0, 0, 7)),
              1e-14);  // clamped before its first
    EXPECT_LT(glm::length(moved(s.objects[0], 3, {0, 0, 0}) - dvec3(3, -7.5, 7)), 1e-13);
}

TEST_F(MeshText, StepsJumpAtTheirKeys) {
    GltfText g;
    g.animate(0, "translation", "STEP", {0, 1, 2}, {0, 0, 0, 5, 0, 0, 9, 0, 0});
    const Object o = read(g).objects.at(0);
    EXPECT_EQ(moved(o, 0.999, dvec3(0)).x, 0);
    EXPECT_EQ(moved(o, 1 - 2 * shortest_key_gap_s, dvec3(0)).x, 0);
    EXPECT_EQ(moved(o, 1, dvec3(0)).x, 5);
    EXPECT_EQ(moved(o, 1.5, dvec3(0)).x, 5);
    EXPECT_EQ(moved(o, 3, dvec3(0)).x, 9);
    EXPECT_EQ(o.keys.size(), 5U);
}

TEST_F(MeshText, AConstantCurveIsNoMotion) {
    GltfText g;
    g.animate(0, "translation", "LINEAR", {0, 1}, {3, 0, 0, 3, 0, 0});
    const Object o = read(g).objects.at(0);
    EXPECT_TRUE(o.keys.empty());
    EXPECT_EQ(o.world_from_object[3].x, 3);
}

TEST_F(MeshText, ACubicRotationIsNormalised) {
    GltfText g;
    // With tangents of 0, q(t) is the normalised blend by 3 t^2 - 2 t^3 of the identity and a rotation by 120
    // degrees about z.
    const double half = std::numbers::pi / 3;
    const auto z = static_cast<float>(std::sin(half)), w = static_cast<float>(std::cos(half));
    g.animate(0, "rotation", "CUBICSPLINE", {0, 1},
              {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, z, w, 0, 0, 0, 0});
    const Object o = read(g).objects.at(0);
    double worst = 0;
    for (int i = 0; i <= 100; ++i) {
        const double t = i / 100.0, b = 3 * t * t - 2 * t * t * t;
        const double angle = 2 * std::atan2(b * static_cast<double>(z), 1 - b + b * static_cast<double>(w));
        worst =
            std::max(worst, glm::length(moved(o, t, {1, 0, 0}) - dvec3(std::cos(angle), std::sin(angle), 0)));
    }
    EXPECT_LT(worst, 1e-4 * std::sqrt(2.0) / 0.93);
}

TEST(Placement, TakesMatricesApart) {
    const Placement p{{1, 2, 3}, glm::angleAxis(2.0, glm::normalize(dvec3(1, -2, 0.5))), {-2, 0.5, 3}};
    const Decomposed d = decompose(matrix_of(p));
    EXPECT_LT(d.error, 1e-14);
    const dmat4 back = matrix_of(d.placement), wanted = matrix_of(p);
    for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(back[c] - wanted[c]), 1e-13);
    dmat4 sheared(1);
    sheared[1].x = 0.5;
    EXPECT_GT(decompose(sheared).error, 0.1);
    dmat4 flat(1);
    flat[2] = glm::dvec4(0);
    EXPECT_EQ(decompose(flat).placement.scale, dvec3(1, 1, 0));
}

TEST_F(MeshText, CamerasAndLightsMoveWithTheirNodes) {
    GltfText g;
    g.nodes =
        R"({"mesh":0},{"children":[2],"scale":[3,3,3]},{"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}})";
    g.roots = "0,1";
    g.more =
        R"("cameras":[{"type":"perspective","perspective":{"yfov":0.5}}],)"
        R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":3.14159265358979,"color":[1,0.5,0],"range":9}]}},)";
    const auto h = static_cast<float>(std::sqrt(0.5));
    g.animate(2, "translation", "LINEAR", {0, 1}, {0, 0, 1, 0, 0, 2});
    g.animate(2, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, h, 0, h});
    const Scene s = read(g, {.lumens_per_watt = 1});
    ASSERT_EQ(s.cameras.size(), 1U);
    ASSERT_EQ(s.lights.size(), 1U);
    for (const double t : {0.0, 0.5, 1.0}) {
        const CameraModel model(s.cameras[0], t);
        const double angle = std::numbers::pi / 2 * t;
        EXPECT_LT(glm::length(model.position - dvec3(0, 0, 3 + 3 * t)), 1e-3);
        EXPECT_LT(glm::length(model.forward - dvec3(-std::sin(angle), 0, -std::cos(angle))), 1e-3);
        for (const TransformKey& k : s.cameras[0].keys) EXPECT_EQ(k.scale, dvec3(1));
    }
    const Light& l = s.lights[0];
    EXPECT_LT(glm::length(l.intensity - dvec3(1, 0.5, 0)), 1e-12);
    EXPECT_EQ(l.attenuation, dvec3(0, 0, 1));
    EXPECT_NEAR(l.cone_degrees, 90, 1e-9);
    EXPECT_EQ(l.cone_soft_degrees, 0);
    EXPECT_EQ(l.keys, s.cameras[0].keys);
    EXPECT_TRUE(notes_have(s, "range of a light"));
    EXPECT_EQ(s.ambient_light, dvec3(0));
}

// Compares the radiance of a diffuse floor of albedo 0.8 with Cycles (measured to 0.1 %), for lights exported
// by Blender.
TEST_F(MeshText, LightsAreDividedByLumensPerWatt) {
    const auto light = [&](const std::string& type, double intensity, const SceneReadOptions& options) {
        GltfText g;
        g.nodes = R"({"mesh":0},{"extensions":{"KHR_lights_punctual":{"light":0}}})";
        g.roots = "0,1";
        g.more = fmt::format(
            R"("extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"{}","intensity":{}}}]}}}},)", type,
            intensity);
        const Scene s = read(g, options);
        EXPECT_EQ(s.lumens_per_watt, options.lumens_per_watt);
        return s.lights.at(0).intensity.x;
    };
    // A sun of 2 W/m^2 at 30 degrees, and a point light of 1000 W at 3 m above the floor.
    const double candela = 1000 / (4 * std::numbers::pi) * 683;
    EXPECT_NEAR(0.8 * light("directional", 2 * 683, {}) * std::cos(std::numbers::pi / 6), 0.441063, 1e-6);
    EXPECT_NEAR(0.8 * light("point", candela, {}) / 9, 2.251581, 1e-6);
    EXPECT_NEAR(0.8 * light("spot", candela, {}) / 9, 2.251581, 1e-6);
    EXPECT_NEAR(light("point", std::numbers::pi, {.lumens_per_watt = 1}), 1, 1e-15);
    EXPECT_NEAR(light("point", std::numbers::pi, {.lumens_per_watt = 4}), 0.25, 1e-15);
    GltfText dark;
    EXPECT_FALSE(read(dark).lumens_per_watt);
}

TEST_F(MeshText, LengthsFollowTheUnit) {
    GltfText g;
    g.nodes =
        R"({"mesh":0,"translation":[10,0,0]},{"translation":[0,5,0],"extensions":{"KHR_lights_punctual":{"light":0}}})";
    g.roots = "0,1";
    g.more = R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},)";
    g.animate(0, "translation", "LINEAR", {0, 1}, {10, 0, 0, 20, 0, 0});
    const Scene s = read(g, {.metres_per_unit = 0.01});
    EXPECT_LT(glm::length(moved(s.objects.at(0), 1, {0.01, 0, 0}) - dvec3(0.21, 0, 0)), 1e-8);
    EXPECT_EQ(s.lights.at(0).position, dvec3(0, 0.05, 0));
    // The light at 5 units of the file is the same as at 5 m.
    EXPECT_NEAR(s.lights[0].attenuation.z * 0.05 * 0.05, 25, 1e-12);
}

// ---- materials

TEST(MetallicRoughness, HasItsLimitsInWhittedsModel) {
    const dvec3 red(0.8, 0.2, 0.1);
    const Material matt = whitted_material({.base = red, .metallic = 0, .roughness = 1});
    EXPECT_EQ(matt.diffuse, red);
    EXPECT_EQ(matt.reflection, dvec3(0));
    EXPECT_EQ(matt.specular, dvec3(0));
    EXPECT_EQ(matt.transmission, dvec3(0));
    const Material mirror = whitted_material({.base = red, .metallic = 1, .roughness = 0});
    EXPECT_EQ(mirror.diffuse, dvec3(0));
    EXPECT_EQ(mirror.reflection, red);
    EXPECT_TRUE(std::isinf(mirror.reflection_exponent));
    const Material rough_metal = whitted_material({.base = red, .metallic = 1, .roughness = 1});
    EXPECT_EQ(rough_metal.diffuse, red);
    EXPECT_EQ(rough_metal.reflection, dvec3(0));
    // F0 is 0.04 for an index of 1.5. A solid body refracts, a thin sheet does not.
    const Material glass =
        whitted_material({.metallic = 0, .roughness = 0, .transmission = 1, .ior = 1.5, .solid = true});
    EXPECT_NEAR(glass.reflection.x, 0.04, 1e-15);
    EXPECT_NEAR(glass.transmission.x, 0.96, 1e-15);
    EXPECT_EQ(glass.diffuse, dvec3(0));
    EXPECT_EQ(glass.ior, 1.5);
    EXPECT_EQ(whitted_material({.metallic = 0, .roughness = 0, .transmission = 1}).ior, 1);
    const Material half = whitted_material({.base = red, .alpha = 0.5, .metallic = 0, .roughness = 1});
    EXPECT_EQ(half.diffuse, 0.5 * red);
    EXPECT_EQ(half.transmission, dvec3(0.5));
    EXPECT_EQ(half.ior, 1);
}

TEST(MetallicRoughness, NeverGivesMoreThanArrives) {
    // In uniform light from all directions, a white surface must not reflect more than it receives.
    for (int i = 0; i <= 10; ++i) {
        for (int j = 0; j <= 10; ++j) {
            for (int k = 0; k <= 10; ++k) {
                const Material m =
                    whitted_material({.metallic = i / 10.0, .roughness = j / 10.0, .transmission = k / 10.0});
                EXPECT_LE(m.diffuse.x + m.diffuse_transmission.x + m.reflection.x + m.transmission.x, 1.05)
                    << i << " " << j << " " << k;
            }
        }
    }
}

TEST_F(MeshText, ExtensionsOfMaterialsAreRead) {
    GltfText g;
    g.mesh.replace(g.mesh.find("}}]"), 3, R"(},"material":0}])");
    g.more =
        R"("materials":[{"name":"lamp","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":0,"roughnessFactor":0},)"
        R"("emissiveFactor":[1,0.5,0],"normalTexture":{"index":0},"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":20},)"
        R"("KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":2},)"
        R"("KHR_materials_volume":{"thicknessFactor":1},"KHR_materials_clearcoat":{}}}],)";
    const Scene s = read(g);
    const Material& m = s.materials.at(s.objects.at(0).material);
    EXPECT_EQ(m.name, "lamp");
    EXPECT_EQ(m.emission, dvec3(20, 10, 0));
    EXPECT_EQ(m.ior, 2);
    EXPECT_NEAR(m.reflection.x, 1.0 / 9, 1e-15);
    EXPECT_LT(glm::length(m.transmission - 8.0 / 9 * dvec3(0.5, 0.25, 1)), 1e-15);
    EXPECT_TRUE(notes_have(s, "normalTexture"));
    EXPECT_TRUE(notes_have(s, "KHR_materials_clearcoat"));
}

// Four colours: red and green above, blue and white below.
Image four_colours() {
    Image image(2, 2);
    image.rgb = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    return image;
}

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(MeshText, PicturesLieAsTheFormatSays) {
    write_image(folder_.path() / "four colours.png", four_colours());
    const std::string png = bytes_of(folder_.path() / "four colours.png");
    const auto document = [&](GltfText& g, const std::string& image) {
        // v runs downwards in glTF, so (0.25, 0.25) is the first texel, which is red.
        const int uv = g.floats({0.25F, 0.25F, 0.75F, 0.25F, 0.25F, 1.75F}, "VEC2");
        g.mesh.replace(g.mesh.find("}}]"), 3, fmt::format(R"(,"TEXCOORD_0":{}}},"material":0}}])", uv));
        g.more =
            R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0,"sampler":0}],)"
            R"("samplers":[{"magFilter":9728}],"images":[{)" +
            image + "}],";
    };
    GltfText by_file, by_data, by_view;
    document(by_file, R"("uri":"four%20colours.png")");
    document(by_data, fmt::format(R"("uri":"data:image/png;base64,{}")", test::base64(png)));
    const int view = by_view.bytes(png);
    document(by_view, fmt::format(R"("bufferView":{},"mimeType":"image/png")", view));
    const std::vector<Scene> scenes{read("f.gltf", by_file.text()), read("d.gltf", by_data.text()),
                                    read("v.glb", by_view.binary())};
    for (const Scene& s : scenes) {
        const Material& m = s.materials.at(s.objects.at(0).material);
        ASSERT_TRUE(m.colour_texture);
        const auto& uv = mesh_of(s.objects[0]).uvs;
        EXPECT_EQ(m.colour_texture->colour({}, uv[0]), dvec3(1, 0, 0));
        EXPECT_EQ(m.colour_texture->colour({}, uv[1]), dvec3(0, 1, 0));
        EXPECT_EQ(m.colour_texture->colour({}, uv[2]), dvec3(0, 0, 1));  // repeated downwards
    }
}

TEST_F(MeshText, TheDigestCoversWhatIsReferredTo) {
    GltfText g;
    write("a b.bin", g.buffer());
    const std::string text = g.text_with_file("a%20b.bin");
    const Scene before = read("t.gltf", text);
    Sha256 digest;
    digest.add(text);
    digest.add("a%20b.bin " + sha256_of_file(folder_.path() / "a b.bin") + "\n");
    EXPECT_EQ(before.sha256, digest.hex());
    write("a b.bin", g.buffer() + "more");
    EXPECT_NE(read("t.gltf", text).sha256, before.sha256);
    // The SHA-256 of an OBJ scene includes its material library.
    write("m.mtl", "newmtl a\nKd 1 0 0\n");
    const std::string obj = "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const Scene first = read("t.obj", obj);
    EXPECT_EQ(first.materials.at(0).diffuse, dvec3(1, 0, 0));
    write("m.mtl", "newmtl a\nKd 0 1 0\n");
    EXPECT_NE(read("t.obj", obj).sha256, first.sha256);
}

TEST_F(MeshText, NothingOutsideOfTheFolderIsRead) {
    fs::create_directories(folder_.path() / "in");
    const GltfText g;
    write("secret.bin", g.buffer());
    write("secret.mtl", "newmtl a\nKd 1 0 0\n");
    fs::create_symlink(folder_.path() / "secret.bin", folder_.path() / "in/link.bin");
    for (const char* uri : {"../secret.bin", "link.bin", "%2e%2e/secret.bin", "/etc/hostname",
                            "file:///etc/hostname", "http://localhost/a.bin"}) {
        EXPECT_THAT(error("in/t.gltf", g.text_with_file(uri)), HasSubstr("buffers[0]")) << uri;
    }
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_THAT(error("in/t.obj", "mtllib ../secret.mtl\n" + triangle),
                HasSubstr("leads out of the scene's folder"));
    write("in/m.mtl", "newmtl a\nmap_Kd ../secret.png\n");
    EXPECT_THAT(error("in/t.obj", "mtllib m.mtl\nusemtl a\n" + triangle),
                HasSubstr("leads out of the scene's folder"));
}

// ---- meshes

TEST_F(MeshText, StripsFansIndicesAndSparseValuesAreTriangles) {
    GltfText g;
    const int square = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
    const std::string bytes("\0\1\2\3", 4);
    const int order = g.accessor(bytes, 5121, 4, "SCALAR");
    const int where = g.bytes(std::string("\2\0\0\0", 4));
    const std::vector<float> value{0, 9, 0};
    const int what = g.bytes({reinterpret_cast<const char*>(value.data()), 12});
    const int sparse = g.accessor(
        {reinterpret_cast<const char*>(std::vector<float>{0, 0, 0, 1, 0, 0, 5, 5, 5}.data()), 36}, 5126, 3,
        "VEC3",
        fmt::format(
            R"(,"sparse":{{"count":1,"indices":{{"bufferView":{},"componentType":5121}},"values":{{"bufferView":{}}}}})",
            where, what));
    g.mesh = fmt::format(
        R"({{"primitives":[{{"mode":5,"indices":{1},"attributes":{{"POSITION":{0}}}}},{{"mode":6,"attributes":{{"POSITION":{0}}}}},)"
        R"({{"attributes":{{"POSITION":{2}}}}},{{"mode":1,"attributes":{{"POSITION":{0}}}}}]}})",
        square, order, sparse);
    const Scene s = read(g);
    ASSERT_EQ(s.objects.size(), 3U);
    EXPECT_EQ(s.objects[0].id, s.objects[2].id);
    const auto& strip = mesh_of(s.objects[0]).triangles;
    ASSERT_EQ(strip.size(), 2U);
    EXPECT_EQ(strip[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(strip[1], glm::uvec3(1, 3, 2));  // with the winding of the first triangle
    EXPECT_EQ(mesh_of(s.objects[1]).triangles.size(), 2U);
    EXPECT_EQ(mesh_of(s.objects[2]).positions[2], glm::vec3(0, 9, 0));
    EXPECT_TRUE(notes_have(s, "points and lines"));
}

TEST_F(MeshText, ColoursOfCornersAreMixed) {
    GltfText g;
    const int colours = g.floats({1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
    g.mesh.replace(g.mesh.find("}}]"), 3, fmt::format(R"(,"COLOR_0":{}}}}}])", colours));
    const Scene s = read(g);
    const RayScene rays(s, 0);
    RayBatch batch;
    batch.clear(false);
    const dvec3 from(0.25, 0.5, 1), along(0, 0, -1);
    batch.add(from, along, std::numeric_limits<float>::infinity());
    rays.intersect(batch, false);
    ASSERT_TRUE(batch.hit(0).valid());
    const SurfacePoint p = rays.surface(batch.hit(0), from, along, 1);
    // The colour is interpolated by the barycentric coordinates of the hit.
    EXPECT_LT(glm::length(dvec3(p.colour) - dvec3(0.25, 0.25, 0.5)), 1e-7);
    EXPECT_EQ(surface_colour(s.materials.at(0), p), dvec3(p.colour));
}

TEST_F(MeshText, TrianglesWithoutAreaAreLeftOut) {
    GltfText g;
    const int p = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 2, 3, 3, 3, 4, 4, 4}, "VEC3");
    g.mesh = fmt::format(R"({{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}})", p);
    const Scene s = read(g);
    EXPECT_EQ(triangles(s), 1U);
    EXPECT_TRUE(notes_have(s, "a triangle without area is left out"));
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

TEST_F(MeshText, ObjPolygonsMayHaveHundredsOfCornersAndLinesMayGoOn) {
    std::string corners, face = "f";
    for (int i = 0; i < 300; ++i) {
        const double turn = 2 * std::numbers::pi * i / 300;
        corners += fmt::format("v {:.9f} {:.9f} 0\n", std::cos(turn), std::sin(turn));
        face += fmt::format(" {}", i + 1);
        if (i % 100 == 99 && i < 299) face += " \\\n";
    }
    EXPECT_EQ(triangles(read("t.obj", "# a disc\n" + corners + face + "\n")), 298U);
}

TEST_F(MeshText, ObjWordsThatAreNoNumbersMoveNoCorner) {
    const std::string rest = "v 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n# to make the file long enough\n";
    EXPECT_EQ(triangles(read("t.obj", "v 0 inf 0\n" + rest)), 1U);
    EXPECT_EQ(triangles(read("t.obj", "v 0 nan 0\n" + rest)), 1U);
    EXPECT_THAT(error("t.obj", "v 0 zero 0\n" + rest), HasSubstr("cannot be read"));
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

TEST_F(MeshText, MtlBecomesWhittedsCoefficients) {
    write("m.mtl",
          "newmtl glass\nKa 0.1 0.2 0.3\nKd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nNs 50\nd 0.25\nTf 1 1 0.5\nNi "
          "1.5\nillum 7\nKe 2 0 0\n"
          "newmtl paint\nKd 0.5 0.5 0.5\nKs 0.3 0.3 0.3\nNs 10\nillum 2\n");
    const Scene s = read(
        "t.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\no a\nusemtl glass\nf 1 2 3\no b\nusemtl paint\nf 1 3 2\n");
    ASSERT_EQ(s.objects.size(), 2U);
    const Material &glass = s.materials[s.objects[0].material], &paint = s.materials[s.objects[1].material];
    const auto near = [](const dvec3& got, const dvec3& wanted) { return glm::length(got - wanted) < 1e-7; };
    EXPECT_TRUE(near(glass.ambient, {0.1, 0.2, 0.3}));
    EXPECT_TRUE(near(glass.diffuse, 0.25 * dvec3(0.8, 0.4, 0.2)));
    EXPECT_TRUE(near(glass.specular, dvec3(0.5)));
    EXPECT_EQ(glass.shininess, 50);
    EXPECT_TRUE(near(glass.reflection, dvec3(0.5)));
    EXPECT_TRUE(near(glass.transmission, 0.75 * dvec3(1, 1, 0.5)));
    EXPECT_NEAR(glass.ior, 1.5, 1e-7);
    EXPECT_TRUE(near(glass.emission, {2, 0, 0}));
    EXPECT_EQ(paint.reflection, dvec3(0));
    EXPECT_EQ(paint.transmission, dvec3(0));
    EXPECT_EQ(paint.ior, 1);
}

TEST(MeshFiles, TextIsMadeUtf8) {
    EXPECT_EQ(as_utf8("plain"), "plain");
    EXPECT_EQ(as_utf8("\xEF\xBB\xBFplain"), "plain");
    EXPECT_EQ(as_utf8(std::string("\xFF\xFE\x41\x00\xE4\x00", 6)), "A\xC3\xA4");
    EXPECT_EQ(as_utf8(std::string("\xFE\xFF\x00\x41\x20\xAC", 6)), "A\xE2\x82\xAC");
}

// ---- broken files

class BrokenGltf : public MeshText {};

TEST_F(BrokenGltf, NumbersAndReferencesAreChecked) {
    const std::string good = GltfText().text();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        const auto at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return error("t.gltf", text.replace(at, from.size(), to));
    };
    EXPECT_EQ(error("t.gltf", good), "no error");
    EXPECT_THAT(with(R"("version":"2.0")", R"("version":"1.0")"), HasSubstr("asset is of another version"));
    EXPECT_THAT(with(R"("nodes":[0])", R"("nodes":[7])"),
                HasSubstr("scenes[0].nodes refers to nothing (got 7"));
    EXPECT_THAT(with(R"("nodes":[0])", R"("nodes":[-1])"), HasSubstr("refers to nothing"));
    EXPECT_THAT(with(R"("nodes":[0])", R"("nodes":[0,0])"), HasSubstr("has nodes[0] twice"));
    EXPECT_THAT(with(R"("nodes":[0])", R"("nodes":[])"), HasSubstr("no objects"));
    EXPECT_THAT(with(R"("mesh":0)", R"("mesh":"0")"), HasSubstr("nodes[0].mesh refers to nothing"));
    EXPECT_THAT(with(R"("mesh":0)", R"("mesh":0,"scale":[1,1])"), HasSubstr("wrong length"));
    EXPECT_THAT(with(R"("mesh":0)", R"("mesh":0,"children":[0])"), HasSubstr("root"));
    EXPECT_THAT(with(R"("count":3)", R"("count":4)"), HasSubstr("runs over its buffer view's end"));
    EXPECT_THAT(with(R"("count":3)", R"("count":1e300)"), HasSubstr("accessors[0].count is out of range"));
    EXPECT_THAT(with(R"("count":3)", R"("count":2)"), HasSubstr("corners left over"));
    EXPECT_THAT(with("5126", "5127"), HasSubstr("unknown componentType"));
    EXPECT_THAT(with("VEC3", "MAT4"), HasSubstr("of a type that does not fit"));
    EXPECT_THAT(with(R"("byteOffset":0)", R"("byteOffset":4)"), HasSubstr("bufferViews[0] runs over"));
    EXPECT_THAT(with(R"("byteOffset":0)", R"("byteOffset":0,"byteStride":4)"), HasSubstr("overlap"));
    EXPECT_THAT(with(R"("byteLength":36}]})", R"("byteLength":37}]})"), HasSubstr("is too short"));
    EXPECT_THAT(with("base64,", "base64,*"), HasSubstr("no base64"));
    EXPECT_THAT(with(R"("asset":)", R"("extensionsRequired":["KHR_draco_mesh_compression"],"asset":)"),
                HasSubstr("requires an extension"));
    EXPECT_THAT(error("t.gltf", "{"), HasSubstr("is no JSON"));
    EXPECT_THAT(error("t.gltf", ""), HasSubstr("is no JSON"));
    EXPECT_THAT(error("t.gltf", R"({"asset": {"version": 1e999999}})"),
                HasSubstr("is no JSON (number overflow"));
    EXPECT_THAT(error("t.gltf", "[]"), HasSubstr("holds no object"));
}

TEST_F(BrokenGltf, ABinaryFileCutAnywhereIsRefused) {
    const std::string whole = GltfText().binary();
    EXPECT_NO_THROW(std::ignore = read("t.glb", whole));
    for (std::size_t length = 0; length < whole.size(); length += length < 32 ? 1 : 37) {
        EXPECT_NE(error("t.glb", whole.substr(0, length)), "no error") << length;
    }
}

TEST_F(BrokenGltf, AnimationsAreChecked) {
    const auto with = [&](const std::vector<float>& times, const std::vector<float>& values,
                          const char* kind) {
        GltfText g;
        g.animate(0, "translation", kind, times, values);
        return error(g);
    };
    EXPECT_EQ(with({0, 1}, {0, 0, 0, 1, 1, 1}, "LINEAR"), "no error");
    EXPECT_THAT(with({1, 1}, {0, 0, 0, 1, 1, 1}, "LINEAR"), HasSubstr("do not grow"));
    EXPECT_THAT(with({0, 1}, {0, 0, 0}, "LINEAR"), HasSubstr("wrong number of values (got 1; expected 2)"));
    EXPECT_THAT(with({0, 1}, {0, 0, 0, 1, 1, 1}, "CUBICSPLINE"), HasSubstr("expected 6"));
    EXPECT_THAT(with({0, 1}, {0, 0, 0, 1, 1, 1}, "SINE"), HasSubstr("unknown interpolation"));
    EXPECT_THAT(with({0, 1}, {0, 0, 0, 1, std::nanf(""), 1}, "LINEAR"), HasSubstr("not finite"));
}

TEST_F(BrokenGltf, DepthAndSizeAreBounded) {
    GltfText chain;
    constexpr int deep = 100'000;
    chain.nodes.clear();
    for (int i = 0; i < deep; ++i) chain.nodes += fmt::format(R"({{"children":[{}]}},)", i + 1);
    chain.nodes += R"({"mesh":0})";
    const Outcome walked = read_apart(write("chain.gltf", chain.text()));
    EXPECT_TRUE(walked.loaded) << walked.text;
    // Every node has the same child twice, which would be 2^40 visits.
    GltfText doubled;
    doubled.nodes.clear();
    for (int i = 0; i < 40; ++i) doubled.nodes += fmt::format(R"({{"children":[{0},{0}]}},)", i + 1);
    doubled.nodes += R"({"mesh":0})";
    EXPECT_THAT(error(doubled), HasSubstr("expected one node above each"));
    const std::string nested(300'000, '[');
    const Outcome nest = read_apart(write("nest.gltf", R"({"asset":{"version":"2.0"},"extras":)" + nested));
    EXPECT_TRUE(nest.refused) << nest.text;
    std::string wide = R"({"asset":{"version":"2.0"},"extras":[)";
    for (int i = 0; i < 5'000'000; ++i) wide += "[],";
    const Outcome flood = read_apart(write("wide.gltf", wide));
    EXPECT_TRUE(flood.refused) << flood.text;
    EXPECT_THAT(flood.text, HasSubstr("too many values"));
    // An accessor without a buffer, whose elements are zero.
    GltfText zeros;
    std::string text = zeros.text();
    const auto at = text.find(R"("bufferView":0,)");
    text.erase(at, 15);
    text.replace(text.find(R"("count":3)"), 9, R"("count":3000000000)");
    const Outcome empty = read_apart(write("zeros.gltf", text));
    EXPECT_TRUE(empty.refused) << empty.text;
}

TEST_F(MeshText, BrokenPlyFilesAreRefused) {
    const auto ply = [](const std::string& format, const std::string& vertices, const std::string& count_type,
                        const std::string& body) {
        return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
               "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list " +
               count_type + " int vertex_indices\nend_header\n" + body;
    };
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(error("t.ply", ply("ascii", "3", "uchar", points + "3 0 1 2\n")), "no error");
    std::map<std::string, std::string> bad{
        {"count", ply("ascii", "3", "uint", points + "400000000 0 1 2\n")},
        {"vertices", ply("ascii", "4000000000", "uchar", points + "3 0 1 2\n")},
        {"index", ply("ascii", "3", "uchar", points + "3 0 1 7\n")},
        {"negative", ply("ascii", "3", "uchar", points + "3 0 1 -2\n")},
        {"word", ply("ascii", "3", "uchar", points + "3 0 one 2\n")},
        {"format", ply("asci", "3", "uchar", points + "3 0 1 2\n")},
        {"binary",
         ply("binary_little_endian", "3", "uint", std::string(36, '0') + "\xFF\xFF\xFF\x7F" + "abcd")},
        {"short", ply("binary_big_endian", "3", "uchar", "0000")},
        {"nothing", "ply\nformat ascii 1.0\nend_header\n"},
        {"header", "ply\nformat ascii 1.0\n"},
        {"empty", ""},
        {"elements", "ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n"},
        {"huge",
         "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nproperty float x\nend_header\n"}};
    for (const auto& [name, text] : bad) {
        const Outcome o = read_apart(write(name + ".ply", text));
        EXPECT_TRUE(o.refused) << name << ": " << o.text;
    }
}

TEST_F(MeshText, BrokenObjFilesAreRefused) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    std::map<std::string, std::string> bad{{"index", points + "f 1 2 7\n"},
                                           {"far", points + "f 1 2 99999999999999999999\n"},
                                           {"relative", points + "f -1 -2 -9\n"},
                                           {"lines", points + "l 1 2\n"},
                                           {"nothing", "# a comment, and nothing else\n"},
                                           {"binary", std::string(2000, '\xFF')},
                                           {"many", points + "f" + [] {
                                                std::string corners;
                                                for (int i = 0; i < 5000; ++i) corners += " 1 2 3";
                                                return corners;
                                            }() + "\n"}};
    for (const auto& [name, text] : bad) {
        const Outcome o = read_apart(write(name + ".obj", text));
        EXPECT_TRUE(o.refused) << name << ": " << o.text;
    }
}

}  // namespace
}  // namespace postlens
