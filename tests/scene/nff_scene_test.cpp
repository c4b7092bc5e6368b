// The Neutral File Format: published scenes, hand-written scenes, and invalid files.
#include <chrono>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <tuple>

#include "core/error.h"
#include "scene/file_digest.h"
#include "scene/scene.h"
#include "scene/shape_bounds.h"
#include "tests/scene/mesh_text.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::nff_scene_test {
namespace {

using glm::dvec3;

struct Counts {
    int spheres = 0, cones = 0, meshes = 0;
    std::size_t triangles = 0;
};

Counts count(const Scene& scene) {
    Counts c;
    for (const Object& o : scene.objects) {
        c.spheres += std::holds_alternative<Sphere>(o.shape) ? 1 : 0;
        c.cones += std::holds_alternative<Cone>(o.shape) ? 1 : 0;
        if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&o.shape)) {
            ++c.meshes;
            c.triangles += (*mesh)->triangles.size();
        }
    }
    return c;
}

std::filesystem::path published(const std::string& name) {
    return std::filesystem::path(POSTLENS_SHARED_DATA) / "nff" / name;
}

std::filesystem::path small(const std::string& name) {
    return std::filesystem::path(POSTLENS_TEST_DATA) / "nff" / name;
}

// Reads scenes from text.
class NffText : public testing::Test {
  protected:
    Scene read(const std::string& text, const SceneReadOptions& options = {}) {
        std::ofstream(path_, std::ios::binary) << text;
        return read_scene(path_, options);
    }
    // The error message without the file's folder.
    std::string error(const std::string& text) {
        try {
            std::ignore = read(text);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            const std::string what = e.what(), folder = folder_.path().string() + "/";
            EXPECT_EQ(what.rfind(folder, 0), 0U) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            return what.substr(folder.size());
        }
        return "no error";
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "t.nff";
};

const std::string view = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 30\nhither 1\nresolution 64 48\n";
const std::string fill = "f 1 0.5 0.25 0.8 0.1 20 0 1\n";

TEST(PublishedNff, HasTheCountsOfItsTable) {
    std::ifstream table(std::filesystem::path(POSTLENS_SHARED_DATA) / "tables" /
                        "spd_published_ray_counts.csv");
    if (!table) GTEST_SKIP() << "the published databases are not beside this tree";
    std::map<std::string, std::size_t> total;
    for (std::string line; std::getline(table, line);) {
        std::istringstream fields(line);
        std::string name, kinds, number;
        std::getline(fields, name, ',');
        std::getline(fields, kinds, ',');
        std::getline(fields, number, ',');
        if (name != "scene") total[name] = std::stoul(number);
    }
    // `balls` has 7381 spheres and a square of two triangles. The polygons of the others are triangles.
    const Counts balls = count(read_scene(published("balls.nff")));
    EXPECT_EQ(balls.triangles, 2U);
    EXPECT_EQ(static_cast<std::size_t>(balls.spheres) + 1, total.at("balls"));
    const Counts mount = count(read_scene(published("mount.nff")));
    EXPECT_EQ(mount.spheres, 4);
    EXPECT_EQ(mount.meshes, 1);
    EXPECT_EQ(static_cast<std::size_t>(mount.spheres) + mount.triangles, total.at("mount"));
    const Counts tetra = count(read_scene(published("tetra.nff")));
    EXPECT_EQ(tetra.meshes, 1);
    EXPECT_EQ(tetra.triangles, total.at("tetra"));
}

TEST(PublishedNff, OthersAreReadWithoutNotes) {
    if (!std::filesystem::exists(published("jacks.nff"))) {
        GTEST_SKIP() << "the published databases are not beside this tree";
    }
    const Scene jacks = read_scene(published("jacks.nff"));
    EXPECT_EQ(count(jacks).spheres, 438);
    EXPECT_EQ(count(jacks).cones, 219);
    EXPECT_EQ(count(read_scene(published("sombrero.nff"))).triangles, 1922U);
    const Scene sample = read_scene(published("sample.nff"));
    bool has_normals = false;
    for (const Object& o : sample.objects) {
        if (std::holds_alternative<std::shared_ptr<const Mesh>>(o.shape))
            has_normals |= !mesh_of(o).normals.empty();
    }
    EXPECT_TRUE(has_normals);  // its patches
    for (const Scene* s : {&jacks, &sample}) EXPECT_TRUE(s->notes.empty()) << s->notes.front();
}

TEST_F(NffText, AByteOrderMarkBeforeTheFirstWordIsNotRead) {
    const std::string mark = "\xEF\xBB\xBF";
    EXPECT_EQ(count(read(mark + view + fill + "s 0 0 0 1\n")).spheres, 1);
    EXPECT_EQ(error(mark + "x\n").find("t.nff:1: unknown entity (got 'x'"), 0U);
    EXPECT_EQ(error("# a comment\n" + mark + view).find("t.nff:2: unknown entity"), 0U);
}

TEST(SmallNff, BallsHaveTheirViewMaterialsAndLights) {
    const Scene s = read_scene(small("balls_s2.nff"));
    EXPECT_EQ(count(s).spheres, 91);
    EXPECT_EQ(count(s).triangles, 2U);
    EXPECT_TRUE(s.notes.empty());
    EXPECT_EQ(s.name, "balls_s2");
    EXPECT_EQ(s.sha256, sha256_of_file(small("balls_s2.nff")));
    EXPECT_EQ(s.background, dvec3(0.078, 0.361, 0.753));
    ASSERT_EQ(s.cameras.size(), 1U);
    const Camera& c = s.cameras[0];
    EXPECT_EQ(c.position, dvec3(2.1, 1.3, 1.7));
    EXPECT_EQ(c.look_at, dvec3(0));
    EXPECT_EQ(c.up, dvec3(0, 0, 1));
    EXPECT_EQ(c.vertical_fov_degrees, 45);
    EXPECT_FALSE(c.focal_length_mm || c.horizontal_fov_degrees);
    EXPECT_TRUE(c.fov_between_pixel_centres);
    EXPECT_EQ(c.width, 512);
    EXPECT_EQ(c.height, 512);
    ASSERT_EQ(s.lights.size(), 3U);
    EXPECT_EQ(s.lights[1].position, dvec3(1, -4, 4));
    const double intensity = std::sqrt(3.0) / 6;
    EXPECT_EQ(s.lights[0].intensity, dvec3(intensity));
    EXPECT_EQ(s.ambient_light, dvec3(intensity));
    ASSERT_EQ(s.materials.size(), 2U);
    const Material& floor = s.materials[s.objects[0].material];
    EXPECT_EQ(floor.diffuse, 0.8 * dvec3(1, 0.75, 0.33));
    EXPECT_EQ(floor.ambient, floor.diffuse);
    EXPECT_EQ(floor.reflection, dvec3(0));
    const Material& ball = s.materials[s.objects[1].material];
    EXPECT_GT(ball.reflection.x, 0);
    EXPECT_EQ(ball.reflection, ball.specular);
    for (std::size_t i = 0; i < s.objects.size(); ++i) EXPECT_EQ(s.objects[i].id, i + 1);
    EXPECT_EQ(s.objects[0].name, "polygons 1");
    EXPECT_EQ(s.objects[12].name, "sphere 12");
}

TEST(SmallNff, MountAndTetraAreMeshes) {
    const Scene mount = read_scene(small("mount_s4.nff"));
    EXPECT_EQ(count(mount).spheres, 4);
    EXPECT_EQ(count(mount).triangles, 512U);
    const Material& glass = mount.materials[0];
    EXPECT_EQ(glass.transmission, dvec3(0.9));
    EXPECT_EQ(glass.ior, 1.5);
    const Scene tetra = read_scene(small("tetra_s3.nff"));
    EXPECT_EQ(count(tetra).triangles, 64U);
    EXPECT_EQ(tetra.objects.size(), 1U);
    EXPECT_TRUE(mesh_of(tetra.objects[0]).normals.empty());
    EXPECT_EQ(tetra.materials[0].ior, 1);  // 0 in the file, because nothing is transmitted
}

bool has_note(const Scene& scene, const std::string& part) {
    for (const std::string& note : scene.notes) {
        if (note.find(part) != std::string::npos) return true;
    }
    return false;
}

TEST(SmallNff, ExtensionsAreSkippedAndNoted) {
    const Scene cone = read_scene(small("assimp_cone.nff"));
    EXPECT_EQ(count(cone).cones, 2);
    EXPECT_EQ(count(cone).spheres, 2);
    EXPECT_TRUE(has_note(cone, "assimp_cone.nff:3: a texture name after 'f'"));
    EXPECT_TRUE(has_note(cone, "assimp_cone.nff:6: 'tess'"));
    EXPECT_TRUE(has_note(cone, ":3: an 'f' line has Ks or T above 1; taken as 1"));
    EXPECT_TRUE(has_note(cone, "no camera"));
    EXPECT_TRUE(has_note(cone, "no light"));
    const Scene spheres = read_scene(small("assimp_spheres.nff"));
    EXPECT_EQ(count(spheres).spheres, 4);
    EXPECT_TRUE(has_note(spheres, ":5: an object stands before any 'f'"));
    EXPECT_TRUE(has_note(spheres, ":8: an 'f' line has fewer than eight numbers"));
    EXPECT_TRUE(has_note(spheres, ":17: numbers after the radius"));
    const Material& short_line = spheres.materials[spheres.objects[1].material];  // f 0 0 1 0 1 1 1
    EXPECT_EQ(short_line.diffuse, dvec3(0));
    EXPECT_EQ(short_line.reflection, dvec3(1));
    EXPECT_EQ(short_line.transmission, dvec3(0, 0, 1));
    EXPECT_EQ(short_line.ior, 1);
    const Scene with_camera = read_scene(small("assimp_WithCamera.nff"));
    EXPECT_EQ(with_camera.cameras[0].width, 640);
    EXPECT_EQ(with_camera.cameras[0].height, 480);
    EXPECT_EQ(with_camera.lights.at(0).position, dvec3(0, 3, 10));
    EXPECT_EQ(with_camera.lights.at(0).intensity, dvec3(0.5));
    EXPECT_EQ(with_camera.notes.size(), 1U);
}

TEST_F(NffText, LightColoursScaleTheirIntensity) {
    const Scene s = read(view + "l 1 2 3 0.5 1 2\nl 4 5 6\n" + fill + "s 0 0 0 1\n");
    const double intensity = std::sqrt(2.0) / 4;
    EXPECT_EQ(s.lights.at(0).intensity, intensity * dvec3(0.5, 1, 2));
    EXPECT_EQ(s.lights.at(1).intensity, dvec3(intensity));
    EXPECT_EQ(s.lights.at(1).position, dvec3(4, 5, 6));
    EXPECT_TRUE(s.notes.empty());
}

TEST_F(NffText, EqualMaterialsAreOne) {
    const Scene s =
        read(view + "l 1 2 3\n" + fill + "s 0 0 0 1\nf 1 1 1 1 0 0 0 1\ns 1 0 0 1\n" + fill + "s 2 0 0 1\n");
    EXPECT_EQ(s.materials.size(), 2U);
    EXPECT_EQ(s.objects[0].material, s.objects[2].material);
    EXPECT_NE(s.objects[0].material, s.objects[1].material);
}

TEST_F(NffText, PolygonsOfOneFillAreOneObject) {
    const std::string triangle = "p 3\n0 0 0\n1 0 0\n0 1 0\n", square = "p 4\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
    const Scene s = read(view + "l 1 2 3\n" + fill + triangle + "# between\n" + square + fill + triangle +
                         "s 0 0 0 1\n" + triangle);
    ASSERT_EQ(s.objects.size(), 4U);
    EXPECT_EQ(mesh_of(s.objects[0]).triangles.size(), 3U);
    EXPECT_EQ(mesh_of(s.objects[0]).positions.size(), 7U);
    EXPECT_EQ(mesh_of(s.objects[1]).triangles.size(), 1U);
    EXPECT_EQ(s.objects[3].name, "polygons 3");
}

TEST_F(NffText, ConcavePolygonsAreCutInside) {
    // The polygon is an arrow head. A fan about its first corner would cover the notch.
    const Scene s = read(view + "l 1 2 3\n" + fill + "p 4\n0 0 0\n4 2 0\n0 4 0\n1 2 0\n");
    const Mesh& m = mesh_of(s.objects[0]);
    float area = 0;
    for (const glm::uvec3& t : m.triangles) {
        area += 0.5F * glm::length(glm::cross(m.positions[t.y] - m.positions[t.x],
                                              m.positions[t.z] - m.positions[t.x]));
    }
    EXPECT_FLOAT_EQ(area, 6);
}

TEST_F(NffText, PatchNormalsAreKeptAndFlatNeighboursGetTheirOwn) {
    const Scene s = read(view + "l 1 2 3\n" + fill +
                         "pp 3\n0 0 0 0 0 2\n1 0 0 3 0 4\n0 1 0 0 0 0\np 3\n0 0 1\n0 1 1\n0 0 2\n");
    const Mesh& m = mesh_of(s.objects[0]);
    ASSERT_EQ(m.normals.size(), 6U);
    EXPECT_EQ(m.normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(m.normals[1], glm::vec3(0.6F, 0, 0.8F));
    EXPECT_EQ(m.normals[2], glm::vec3(0, 0, 1));  // of length 0 in the file: the polygon's normal is used
    EXPECT_EQ(m.normals[3], glm::vec3(1, 0, 0));
}

TEST_F(NffText, ConesAreOpenAndMayStandOnOneLineOrTwo) {
    const Scene s = read(view + "l 1 2 3\n" + fill + "c\n0 0 0 2\n0 0 3 1\nc 0 0 0 1 0 0 3 1\n");
    const Cone& a = std::get<Cone>(s.objects.at(0).shape);
    EXPECT_EQ(a.base_radius, 2);
    EXPECT_EQ(a.apex_radius, 1);
    EXPECT_EQ(a.apex, dvec3(0, 0, 3));
    EXPECT_FALSE(a.capped);
    EXPECT_EQ(std::get<Cone>(s.objects.at(1).shape).base_radius, 1);
}

TEST_F(NffText, NegativeRadiiAreNotedAndTakenAsPositive) {
    const Scene s = read(view + "l 1 2 3\n" + fill + "s 0 0 0 -2\nc 0 0 0 -2 0 0 1 -1\n");
    EXPECT_EQ(std::get<Sphere>(s.objects.at(0).shape).radius, 2);
    EXPECT_EQ(std::get<Cone>(s.objects.at(1).shape).base_radius, 2);
    ASSERT_EQ(s.notes.size(), 1U);
    EXPECT_TRUE(has_note(s, "t.nff:10: a negative radius asks for the inside only"));
    EXPECT_TRUE(has_note(s, "(3 times)"));
}

TEST_F(NffText, LengthsFollowTheUnitAndAnglesDoNot) {
    const std::string text =
        view + "l 1 2 3\n" + fill + "s 1 2 3 4\nc 1 0 0 2 0 0 3 1\np 3\n1 0 0\n2 0 0\n0 1 0\n";
    const Scene s = read(text, {.metres_per_unit = 0.01});
    EXPECT_EQ(std::get<Sphere>(s.objects[0].shape).centre, 0.01 * dvec3(1, 2, 3));
    EXPECT_EQ(std::get<Sphere>(s.objects[0].shape).radius, 0.04);
    EXPECT_EQ(std::get<Cone>(s.objects[1].shape).base_radius, 0.02);
    EXPECT_EQ(mesh_of(s.objects[2]).positions[1], glm::vec3(0.02F, 0, 0));
    EXPECT_EQ(s.cameras[0].position, dvec3(0, 0, 0.05));
    EXPECT_EQ(s.lights[0].position, 0.01 * dvec3(1, 2, 3));
    EXPECT_EQ(s.cameras[0].vertical_fov_degrees, 30);
    EXPECT_EQ(s.cameras[0].up, dvec3(0, 1, 0));
}

TEST_F(NffText, AMadeCameraSeesEverything) {
    const Scene s = read("l 1 2 3\n" + fill + "s 10 0 0 2\ns -3 5 1 1\n");
    ASSERT_EQ(s.cameras.size(), 1U);
    const Camera& c = s.cameras[0];
    const dvec3 forward = glm::normalize(c.look_at - c.position),
                right = glm::normalize(glm::cross(forward, c.up));
    const double half_width = 0.5 * c.film_width_mm / *c.focal_length_mm,
                 half_height = half_width * c.height / c.width;
    for (const Object& o : s.objects) {
        const Bounds box = shape_bounds(o.shape, o.world_from_object);
        for (int corner = 0; corner < 8; ++corner) {
            const dvec3 p = dvec3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                  corner & 4 ? box.max.z : box.min.z) -
                            c.position;
            const double depth = glm::dot(p, forward);
            EXPECT_GT(depth, 0);
            EXPECT_LE(std::abs(glm::dot(p, right)), half_width * depth);
            EXPECT_LE(std::abs(glm::dot(p, glm::cross(right, forward))), half_height * depth);
        }
    }
}

TEST_F(NffText, CarriageReturnsTabsPlusSignsAndCommentsAreRead) {
    const Scene s = read("# first\r\nl\t+1 2 3 # a light\r\nf 1 1 1 1 0 0 0 1\r\ns 0 0 0 1# close\r\n");
    EXPECT_EQ(s.lights.at(0).position, dvec3(1, 2, 3));
    EXPECT_EQ(s.objects.size(), 1U);
}

TEST_F(NffText, ErrorsNameTheLine) {
    EXPECT_EQ(error(""), "t.nff: the scene has no objects (expected at least one that is not hidden)");
    EXPECT_EQ(error("# nothing\n"),
              "t.nff: the scene has no objects (expected at least one that is not hidden)");
    EXPECT_EQ(error("hello\n"), "t.nff:1: unknown entity (got 'hello'; expected v, b, l, f, c, s, p or pp)");
    EXPECT_EQ(error("\n\ns 0 0 zero 1\n"), "t.nff:3: sphere centre is not a number (got 'zero')");
    EXPECT_EQ(error("s 0 0 0 nan\n"),
              "t.nff:1: sphere radius is out of range (got 'nan'; expected a finite number up to 1e+12)");
    EXPECT_EQ(error("s inf 0 0 1\n"),
              "t.nff:1: sphere centre is out of range (got 'inf'; expected a finite number up to 1e+12)");
    EXPECT_EQ(error("s 0 0 0 1e999\n"),
              "t.nff:1: sphere radius is out of range (got '1e999'; expected a finite number up to 1e+12)");
    EXPECT_EQ(error("s 1e200 0 0 1\n"),
              "t.nff:1: sphere centre is out of range (got '1e200'; expected a finite number up to 1e+12)");
    EXPECT_EQ(error("s 0 0 0 0\n"),
              "t.nff:1: sphere radius is out of range (got 0; expected at least 1e-12 m)");
    EXPECT_EQ(error("s 0 0\n"), "t.nff:1: sphere centre: the file ends too early (expected a number)");
    EXPECT_EQ(error("s 0 0 0\n" + fill), "t.nff:2: sphere radius is not a number (got 'f')");
    EXPECT_EQ(error("c 0 0 0 1 0 0 0 1\n"),
              "t.nff:1: base and apex of a cone coincide (expected at least 1e-12 m between them)");
    EXPECT_EQ(
        error("c 0 0 0 0 0 0 1 0\n"),
        "t.nff:1: both radii of a cone are out of range (got 0 and 0; expected one of at least 1e-12 m)");
}

TEST_F(NffText, PolygonErrorsNameTheLine) {
    EXPECT_EQ(error("p 2\n0 0 0\n1 0 0\n"),
              "t.nff:1: number of vertices is out of range (got 2; expected a whole number of 3 to 4096)");
    EXPECT_EQ(
        error("p 4000000000\n0 0 0\n"),
        "t.nff:1: number of vertices is out of range (got 4000000000; expected a whole number of 3 to 4096)");
    EXPECT_EQ(error("p 3.5\n"),
              "t.nff:1: number of vertices is out of range (got 3.5; expected a whole number of 3 to 4096)");
    EXPECT_EQ(error("p 3\n0 0 0\n1 0 0\n" + fill), "t.nff:4: vertex is not a number (got 'f')");
    EXPECT_EQ(error("p 3\n0 0 0\n1 0 0\n"), "t.nff:3: vertex: the file ends too early (expected a number)");
    EXPECT_EQ(
        error("p 3\n0 0 0\n1 0 0\n0 1 0\n5 5 5\n"),
        "t.nff:5: more numbers than the entity before has (got '5'; expected v, b, l, f, c, s, p or pp)");
    EXPECT_EQ(error("p 4\n0 0 0\n2 2 0\n2 0 0\n0 1 0\n"), "t.nff:5: the polygon crosses itself");
    const Scene s = read(view + "l 0 0 9\n" + fill + "p 3\n0 0 0\n1 1 1\n2 2 2\np 3\n0 0 0\n1 0 0\n0 1 0\n");
    EXPECT_EQ(count(s).triangles, 1U);
    EXPECT_TRUE(has_note(s, "t.nff:10: a polygon without area is skipped"));
}

TEST_F(NffText, ViewErrorsNameTheLine) {
    EXPECT_EQ(error("v\nfrom 0 0 5\nat 0 0 0\n"), "t.nff:3: the view has no 'up'");
    EXPECT_EQ(error("v\nfrom 0 0 5\nfrom 0 0 0\n"), "t.nff:3: the view has 'from' twice");
    EXPECT_EQ(error("v\nfrom 0 0 5\nat 0 0 5\nup 0 1 0\nangle 30\nresolution 4 4\n"),
              "t.nff:6: 'from', 'at' and 'up' do not span a view");
    EXPECT_EQ(error("v\nfrom 0 0 5\nat 0 0 0\nup 0 0 2\nangle 30\nresolution 4 4\n"),
              "t.nff:6: 'from', 'at' and 'up' do not span a view");
    EXPECT_EQ(error("v\nangle 180\n"),
              "t.nff:2: 'angle' is out of range (got 180; expected more than 0, less than 180 degrees)");
    EXPECT_EQ(error("v\nresolution 512 1\n"),
              "t.nff:2: 'resolution' is out of range (got 1; expected a whole number of 2 to 65536 px)");
    EXPECT_EQ(
        error("v\nresolution 1e6 512\n"),
        "t.nff:2: 'resolution' is out of range (got 1000000; expected a whole number of 2 to 65536 px)");
}

TEST_F(NffText, LineEntitiesCountTheirNumbers) {
    EXPECT_EQ(error("b 1 1\n"), "t.nff:1: a background has three numbers (got 2)");
    EXPECT_EQ(error("b 1 1 -1\n"), "t.nff:1: background is out of range (got -1; expected at least 0)");
    EXPECT_EQ(error("l 1 2 3 4\n"), "t.nff:1: a light has three numbers, or six with a colour (got 4)");
    EXPECT_EQ(error("f 1 1\n"), "t.nff:1: a fill has eight numbers, at least its colour (got 2)");
    EXPECT_EQ(error("f 1 1 1 1 1 1 1 1 1\n"), "t.nff:1: a fill has eight numbers (got more)");
    EXPECT_EQ(error("f 1 1 1 x 1 1 1 1\n"), "t.nff:1: fill is not a number (got 'x')");
    EXPECT_EQ(error("f 1 1 1 -1\n"), "t.nff:1: fill is out of range (got -1; expected at least 0)");
    EXPECT_EQ(error("f 1 1 1 1 0 0 0.5 0\n"),
              "t.nff:1: index of refraction is out of range (got 0; expected above 0)");
}

TEST_F(NffText, EveryTruncationIsAnErrorOrAScene) {
    const std::string text = view + "b 0 0 1\nl 1 2 3 1 1 1\n" + fill +
                             "s 0 0 0 1\nc 0 0 0 1 0 0 1 1\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n";
    int errors = 0;
    for (std::size_t length = 0; length < text.size(); ++length) {
        errors += error(text.substr(0, length)) == "no error" ? 0 : 1;
    }
    EXPECT_GT(errors, 100);
}

TEST_F(NffText, LargeGarbageFailsAtOnce) {
    const auto start = std::chrono::steady_clock::now();
    std::ofstream(path_, std::ios::binary) << "\x7f"
                                              "ELF";
    std::filesystem::resize_file(path_, 100'000'000);  // 100 MB of zeros
    EXPECT_THROW(std::ignore = read_scene(path_), Error);
    std::ofstream(path_, std::ios::binary) << "#" << std::string(1'000'000, 'x');  // a comment without an end
    std::filesystem::resize_file(path_, 100'000'000);
    EXPECT_THROW(std::ignore = read_scene(path_), Error);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

}  // namespace
}  // namespace postlens::test::nff_scene_test
