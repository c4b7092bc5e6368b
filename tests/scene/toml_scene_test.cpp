// The .toml scene format: all keys, all errors, the sample scenes.
#include "scene/toml/toml_scene.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>

#include "core/error.h"
#include "scene/file_digest.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"

namespace postlens {
namespace {

using glm::dvec3;

const std::filesystem::path samples = std::filesystem::path(POSTLENS_SAMPLES) / "scenes";

const std::string ball = "[[object]]\nshape = 'sphere'\nradius_m = 1\n";

class TomlText : public testing::Test {
  protected:
    Scene read(const std::string& text, const SceneReadOptions& options = {}) {
        std::ofstream(path_, std::ios::binary) << text;
        return read_scene(path_, options);
    }
    // The error message from "LINE:COLUMN: " on; the file's name before it is checked and removed.
    std::string error(const std::string& text) {
        try {
            std::ignore = read(text);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            const std::string what = e.what();
            EXPECT_EQ(what.rfind(path_.string() + ":", 0), 0U) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            return what.substr(path_.string().size() + 1);
        }
        return "no error";
    }
    // The error message for a key, in line 4, of an object that is otherwise valid.
    std::string ball_error(const std::string& line) { return error(ball + line + "\n"); }
    // The only object of a file with this table.
    Object object(const std::string& keys, const SceneReadOptions& options = {}) {
        const Scene s = read("[[object]]\n" + keys, options);
        EXPECT_EQ(s.objects.size(), 1U);
        return s.objects.at(0);
    }
    Camera camera(const std::string& keys, const SceneReadOptions& options = {}) {
        return read(ball + "[[camera]]\n" + keys, options).cameras.at(0);
    }
    Light light(const std::string& keys, const SceneReadOptions& options = {}) {
        return read(ball + "[[light]]\n" + keys, options).lights.at(0);
    }
    Material material(const std::string& keys) {
        return read(ball + "[[material]]\nname = 'm'\n" + keys).materials.at(0);
    }

    test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "t.toml";
};

void expect_near(const dvec3& a, const dvec3& b) {
    EXPECT_NEAR(a.x, b.x, 1e-13);
    EXPECT_NEAR(a.y, b.y, 1e-13);
    EXPECT_NEAR(a.z, b.z, 1e-13);
}

dvec3 at(const glm::dmat4& m, const dvec3& p) {
    return dvec3(m * glm::dvec4(p, 1));
}

TEST_F(TomlText, DefaultsAreTheDocumentedOnes) {
    const Scene s = read(ball + "[[camera]]\n[[light]]\nkind = 'point'\nposition_m = [0, 0, 0]\n");
    EXPECT_EQ(s.name, "t");
    EXPECT_EQ(s.background, dvec3(0));
    EXPECT_EQ(s.ambient_light, dvec3(1));
    EXPECT_EQ(s.time_s, 0);
    EXPECT_TRUE(s.notes.empty());
    const Camera& c = s.cameras.at(0);
    EXPECT_EQ(c.name, "camera 1");
    EXPECT_EQ(c.projection, Camera::Projection::perspective);
    EXPECT_EQ(c.position, dvec3(0));
    EXPECT_EQ(c.look_at, dvec3(0, 0, -1));
    EXPECT_EQ(c.up, dvec3(0, 1, 0));
    EXPECT_EQ(c.film_width_mm, 36);
    EXPECT_EQ(c.focal_length_mm, 50);
    EXPECT_EQ(c.width, 960);
    EXPECT_EQ(c.height, 540);
    EXPECT_FALSE(c.f_number || c.focus_m || c.exposure_s || c.fov_between_pixel_centres);
    const Light& l = s.lights.at(0);
    EXPECT_EQ(l.name, "light 1");
    EXPECT_EQ(l.intensity, dvec3(1));
    EXPECT_EQ(l.attenuation, dvec3(1, 0, 0));
    EXPECT_TRUE(l.casts_shadows);
    const Object& o = s.objects.at(0);
    EXPECT_EQ(o.name, "sphere 1");
    EXPECT_EQ(o.id, 1U);
    EXPECT_TRUE(o.casts_shadows);
    EXPECT_TRUE(o.keys.empty());
    const Material& m = s.materials.at(o.material);
    EXPECT_EQ(m.name, "default");
    EXPECT_EQ(m.ambient, dvec3(0.1));
    EXPECT_EQ(m.diffuse, dvec3(0.8));
}

TEST_F(TomlText, SceneKeys) {
    const Scene s =
        read("[scene]\nname = 'x'\nbackground = [1, 2, 3]\nambient_light = 0.5\ntime_s = -2.5\n" + ball);
    EXPECT_EQ(s.name, "x");
    EXPECT_EQ(s.background, dvec3(1, 2, 3));
    EXPECT_EQ(s.ambient_light, dvec3(0.5));
    EXPECT_EQ(s.time_s, -2.5);
    EXPECT_EQ(s.sha256, sha256_of_file(path_));
}

TEST_F(TomlText, MaterialKeys) {
    const Material m = material(
        "colour = [0.5, 1, 0]\nambient = 0.2\ndiffuse = [1, 0.5, 1]\ndiffuse_transmission = 0.4\nspecular = "
        "0.7\n"
        "shininess = 90\nreflection = [0.1, 0.2, 0.3]\ntransmission = 0.9\nior = 1.33\nemission = [5, 6, "
        "7]\n");
    EXPECT_EQ(m.name, "m");
    EXPECT_EQ(m.ambient, dvec3(0.1, 0.2, 0));
    EXPECT_EQ(m.diffuse, dvec3(0.5, 0.5, 0));
    EXPECT_EQ(m.diffuse_transmission, dvec3(0.2, 0.4, 0));
    EXPECT_EQ(m.specular, dvec3(0.7));
    EXPECT_EQ(m.shininess, 90);
    EXPECT_EQ(m.reflection, dvec3(0.1, 0.2, 0.3));
    EXPECT_EQ(m.transmission, dvec3(0.9));
    EXPECT_EQ(m.ior, 1.33);
    EXPECT_EQ(m.emission, dvec3(5, 6, 7));
}

TEST_F(TomlText, CheckerTextures) {
    const std::string text =
        "[[texture]]\nname = 'c'\nkind = 'checker'\nsize_m = [1, inf, 2]\noffset_m = [0.5, 0, 0]\neven = "
        "0.9\nodd = [1, 0, 0]\n"
        "[[texture]]\nname = 'uv'\nkind = 'checker_uv'\nsize_uv = [0.5, 0.25]\noffset_uv = [0.25, 0]\n"
        "[[material]]\nname = 'm'\ncolour_texture = 'c'\nemission_texture = 'uv'\n" +
        ball;
    Scene s = read(text);
    const Texture& c = *s.materials.at(0).colour_texture;
    EXPECT_EQ(c.colour({0.5, -77, 0}, {}), dvec3(0.9));
    EXPECT_EQ(c.colour({0.49, 77, 0}, {}), dvec3(1, 0, 0));
    EXPECT_EQ(c.colour({0.5, 0, 2}, {}), dvec3(1, 0, 0));
    const Texture& uv = *s.materials.at(0).emission_texture;
    EXPECT_EQ(uv.colour({}, {0.25, 0}), dvec3(1));
    EXPECT_EQ(uv.colour({}, {0.25, 0.25}), dvec3(0));
    s = read(text, {.metres_per_unit = 0.1});  // lengths follow the unit, (u, v) does not
    EXPECT_EQ(s.materials.at(0).colour_texture->colour({0.051, 0, 0}, {}), dvec3(0.9));
    EXPECT_EQ(s.materials.at(0).colour_texture->colour({0.151, 0, 0}, {}), dvec3(1, 0, 0));
    EXPECT_EQ(s.materials.at(0).emission_texture->colour({}, {0.25, 0.25}), dvec3(0));
}

void write_picture(const std::filesystem::path& path) {
    std::ofstream(path, std::ios::binary) << "P6\n2 1\n255\n" << std::string("\xFF\0\0\0\0\xFF", 6);
}

TEST_F(TomlText, ImageTexturesComeFromTheScenesFolderAndCountInTheHash) {
    std::filesystem::create_directory(folder_.path() / "pictures");
    write_picture(folder_.path() / "pictures" / "a.ppm");
    const std::string text =
        "[[texture]]\nname = 'i'\nkind = 'image'\nfile = 'pictures/a.ppm'\nrepeat = [2, 1]\nfilter = "
        "'nearest'\n"
        "[[material]]\nname = 'm'\ncolour_texture = 'i'\n" +
        ball;
    const Scene s = read(text);
    const Texture& t = *s.materials.at(0).colour_texture;
    EXPECT_EQ(t.colour({}, {0.1, 0.5}), dvec3(1, 0, 0));
    EXPECT_EQ(t.colour({}, {0.3, 0.5}), dvec3(0, 0, 1));
    EXPECT_EQ(t.colour({}, {0.6, 0.5}), dvec3(1, 0, 0));
    Sha256 expected;
    expected.add(text + "pictures/a.ppm " + sha256_of_file(folder_.path() / "pictures" / "a.ppm") + "\n");
    EXPECT_EQ(s.sha256, expected.hex());
    std::ofstream(folder_.path() / "pictures" / "a.ppm", std::ios::binary) << "P6\n2 1\n255\n"
                                                                           << "abcdef";
    EXPECT_NE(read(text).sha256, s.sha256);
}

TEST_F(TomlText, ImageFilesOutsideTheFolderAreRefused) {
    const std::string start = "[[texture]]\nname = 'i'\nkind = 'image'\nfile = '", end = "'\n" + ball;
    const auto refused = [](const std::string& file) {
        return "4:8: texture 'i': 'file' leads out of the scene's folder (got '" + file +
               "'; expected a path inside it)";
    };
    write_picture(folder_.path().parent_path() / "postlens_outside.ppm");
    for (const std::string file :
         {"../postlens_outside.ppm", "/etc/passwd", "a/../../postlens_outside.ppm"}) {
        EXPECT_EQ(error(start + file + end), refused(file));
    }
    std::filesystem::create_symlink("../postlens_outside.ppm", folder_.path() / "link.ppm");
    EXPECT_EQ(error(start + "link.ppm" + end), refused("link.ppm"));
    std::filesystem::remove(folder_.path().parent_path() / "postlens_outside.ppm");
    const std::string here = std::filesystem::canonical(folder_.path()).string();
    EXPECT_EQ(error(start + "none.png" + end),
              "4:8: texture 'i': " + here + "/none.png: cannot be read: no such file");
    EXPECT_EQ(error(start + "." + end).rfind("4:8: texture 'i': ", 0), 0U);
    std::ofstream(folder_.path() / "bad.png") << "no picture";
    EXPECT_EQ(error(start + "bad.png" + end).rfind("4:8: texture 'i': ", 0), 0U);
}

TEST_F(TomlText, SphereBoxDiscRectanglePlane) {
    const Sphere sphere =
        std::get<Sphere>(object("shape = 'sphere'\ncentre_m = [1, 2, 3]\nradius_m = 0.5\n").shape);
    EXPECT_EQ(sphere.centre, dvec3(1, 2, 3));
    EXPECT_EQ(sphere.radius, 0.5);
    const Box corners = std::get<Box>(object("shape = 'box'\nmin_m = [0, 1, 2]\nmax_m = [3, 4, 5]\n").shape);
    EXPECT_EQ(corners.min, dvec3(0, 1, 2));
    EXPECT_EQ(corners.max, dvec3(3, 4, 5));
    const Box cube = std::get<Box>(object("shape = 'box'\ncentre_m = [1, 0, 0]\nsize_m = 2\n").shape);
    EXPECT_EQ(cube.min, dvec3(0, -1, -1));
    EXPECT_EQ(cube.max, dvec3(2, 1, 1));
    const Box slab = std::get<Box>(object("shape = 'box'\nsize_m = [2, 4, 6]\n").shape);
    EXPECT_EQ(slab.max, dvec3(1, 2, 3));
    const Disc disc = std::get<Disc>(
        object("shape = 'disc'\ncentre_m = [1, 0, 0]\nnormal = [0, 2, 0]\nradius_m = 3\ninner_radius_m = 1\n")
            .shape);
    EXPECT_EQ(disc.centre, dvec3(1, 0, 0));
    EXPECT_EQ(disc.normal, dvec3(0, 1, 0));
    EXPECT_EQ(disc.radius, 3);
    EXPECT_EQ(disc.inner_radius, 1);
    const Rectangle r = std::get<Rectangle>(
        object("shape = 'rectangle'\ncorner_m = [1, 0, 0]\nedge_u_m = [2, 0, 0]\nedge_v_m = [1, 3, 0]\n")
            .shape);
    EXPECT_EQ(r.corner, dvec3(1, 0, 0));
    EXPECT_EQ(r.edge_u, dvec3(2, 0, 0));
    EXPECT_EQ(r.edge_v, dvec3(1, 3, 0));
    const Plane plane =
        std::get<Plane>(object("shape = 'plane'\npoint_m = [0, -1, 0]\nnormal = [0, 5, 0]\n").shape);
    EXPECT_EQ(plane.point, dvec3(0, -1, 0));
    EXPECT_EQ(plane.normal, dvec3(0, 1, 0));
}

TEST_F(TomlText, CylinderAndCone) {
    const Cone cylinder = std::get<Cone>(
        object("shape = 'cylinder'\nbase_m = [0, 0, 0]\napex_m = [0, 2, 0]\nradius_m = 0.5\n").shape);
    EXPECT_EQ(cylinder.base_radius, 0.5);
    EXPECT_EQ(cylinder.apex_radius, 0.5);
    EXPECT_EQ(cylinder.apex, dvec3(0, 2, 0));
    EXPECT_TRUE(cylinder.capped);
    const Cone cone = std::get<Cone>(
        object("shape = 'cone'\nbase_m = [0, 0, 1]\napex_m = [0, 2, 0]\nbase_radius_m = 1\ncapped = false\n")
            .shape);
    EXPECT_EQ(cone.base, dvec3(0, 0, 1));
    EXPECT_EQ(cone.base_radius, 1);
    EXPECT_EQ(cone.apex_radius, 0);
    EXPECT_FALSE(cone.capped);
    EXPECT_EQ(std::get<Cone>(object("shape = 'cone'\nbase_m = [0, 0, 1]\napex_m = [0, 2, 0]\nbase_radius_m = "
                                    "0\napex_radius_m = 3\n")
                                 .shape)
                  .apex_radius,
              3);
}

TEST_F(TomlText, MeshFacesBecomeTriangles) {
    const Object o = object(
        "shape = 'mesh'\npositions_m = [[0, 0, 0], [4, 2, 0], [0, 4, 0], [1, 2, 0], [0, 0, 1]]\n"
        "faces = [[0, 1, 2, 3], [0, 1, 4]]\nnormals = [[0, 0, 2], [0, 0, 1], [0, 0, 1], [0, 0, 1], [3, 0, "
        "4]]\n"
        "uvs = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]]\n");
    const Mesh& m = *std::get<std::shared_ptr<const Mesh>>(o.shape);
    ASSERT_EQ(m.triangles.size(), 3U);
    EXPECT_EQ(m.triangles[2], glm::uvec3(0, 1, 4));
    float area = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const glm::uvec3 t = m.triangles[i];
        area += 0.5F * glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x]).z;
    }
    EXPECT_FLOAT_EQ(area, 6);
    EXPECT_EQ(m.normals.at(0), glm::vec3(0, 0, 1));
    EXPECT_EQ(m.normals.at(4), glm::vec3(0.6F, 0, 0.8F));
    EXPECT_EQ(m.uvs.at(4), glm::vec2(0.5F, 0.5F));
}

TEST_F(TomlText, TransformsScaleThenTurnThenMove) {
    const auto m = [&](const std::string& keys) {
        return object("shape = 'sphere'\nradius_m = 1\n" + keys).world_from_object;
    };
    EXPECT_EQ(m(""), glm::dmat4(1));
    expect_near(
        at(m("translate_m = [1, 2, 3]\nrotate_degrees = 90\nrotate_axis = [0, 0, 7]\nscale = [2, 1, 1]\n"),
           {1, 0, 0}),
        {1, 4, 3});
    expect_near(at(m("scale = 3\n"), {1, 1, 1}), {3, 3, 3});
    // Three angles rotate about x first, then y, then z.
    expect_near(at(m("rotate_degrees = [90, 0, 90]\n"), {0, 1, 0}), {0, 0, 1});
    expect_near(at(m("rotate_degrees = [90, 90, 0]\n"), {0, 1, 0}), {1, 0, 0});
    expect_near(at(m("rotate_degrees = [0, 90, 90]\n"), {1, 0, 0}), {0, 0, -1});
    expect_near(at(m("quaternion = [1, 0, 0, 1]\n"), {1, 0, 0}), {0, 1, 0});  // w first; any length
    expect_near(at(m("matrix = [[0, -2, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]\n"), {1, 1, 1}), {3, 7, 8});
    expect_near(at(m("matrix = [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]\n"), {0, 0, 0}),
                {5, 6, 7});
}

TEST_F(TomlText, MotionStandsBeforeTheOwnTransform) {
    const Scene s =
        read("[scene]\ntime_s = 1\n" + ball +
             "translate_m = [1, 0, 0]\nkeys = [{ time_s = 0 }, { time_s = 2, translate_m = [0, 4, 0], "
             "rotate_degrees = 90, rotate_axis = [0, 0, 1], scale = 3 }]\n");
    const Object& o = s.objects.at(0);
    ASSERT_EQ(o.keys.size(), 2U);
    EXPECT_EQ(o.keys[1].time_s, 2);
    EXPECT_EQ(o.keys[1].translation, dvec3(0, 4, 0));
    EXPECT_EQ(o.keys[1].scale, dvec3(3));
    expect_near(at(o.motion_base, {}), {1, 0, 0});
    expect_near(at(transform_at(o.keys, 2) * o.motion_base, {}), {0, 7, 0});
    EXPECT_EQ(o.world_from_object, transform_at(o.keys, 1) * o.motion_base);  // at the scene's instant
    const double half = std::sqrt(0.5);
    expect_near(at(o.world_from_object, {}), dvec3(0, 2, 0) + 2.0 * dvec3(half, half, 0));
}

TEST_F(TomlText, RepetitionsAreObjectsOfTheirOwn) {
    const std::string named =
        "[[object]]\nname = 'b'\nshape = 'sphere'\nradius_m = 1\ntranslate_m = [10, 0, 0]\nscale = 2\n";
    const Scene grid = read(named + "repeat = { count = [2, 1, 3], step_m = [1, 5, -1] }\n");
    ASSERT_EQ(grid.objects.size(), 6U);
    EXPECT_EQ(grid.objects[0].name, "b[0,0,0]");
    EXPECT_EQ(grid.objects[5].name, "b[1,0,2]");
    expect_near(at(grid.objects[5].world_from_object, {1, 0, 0}), {13, 0, -2});
    EXPECT_EQ(grid.objects[5].id, 6U);
    const Scene line = read(named + "repeat = { count = 3, step_m = [1, 0, -1] }\n");
    ASSERT_EQ(line.objects.size(), 3U);
    EXPECT_EQ(line.objects[2].name, "b[2]");
    expect_near(at(line.objects[2].world_from_object, {}), {12, 0, -2});
    const Scene listed = read(named + "repeat = { at_m = [[0, 0, 0], [0, 7, 0]] }\n");
    ASSERT_EQ(listed.objects.size(), 2U);
    EXPECT_EQ(listed.objects[1].name, "b[1]");
    expect_near(at(listed.objects[1].world_from_object, {}), {10, 7, 0});
}

TEST_F(TomlText, InstancesShowWhatTheyName) {
    const Scene s = read(
        "[[material]]\nname = 'red'\n[[material]]\nname = 'blue'\n"
        "[[object]]\nname = 'post'\nshape = 'cylinder'\nbase_m = [0, 0, 0]\napex_m = [0, 1, 0]\nradius_m = "
        "0.1\n"
        "hidden = true\nmaterial = 'red'\ncasts_shadows = false\n"
        "[[object]]\nname = 'fence'\nshape = 'instance'\nof = 'post'\nhidden = true\nrepeat = { count = 3, "
        "step_m = [1, 0, 0] }\n"
        "[[object]]\nname = 'knob'\nshape = 'sphere'\nradius_m = 0.2\ntranslate_m = [0, 1, 0]\nmaterial = "
        "'blue'\n"
        "[[object]]\nname = 'garden'\nshape = 'instance'\nof = ['fence', 'knob']\ntranslate_m = [0, 0, "
        "-5]\nscale = 2\n"
        "[[object]]\nname = 'blue fence'\nshape = 'instance'\nof = 'fence'\nmaterial = 'blue'\ncasts_shadows "
        "= true\n"
        "keys = [{ time_s = 0 }, { time_s = 1, translate_m = [0, 0, 1] }]\n");
    ASSERT_EQ(s.objects.size(), 1U + 4U + 3U);
    EXPECT_EQ(s.objects[0].name, "knob");
    for (std::size_t i = 1; i <= 4; ++i) {
        EXPECT_EQ(s.objects[i].name, "garden");
        EXPECT_EQ(s.objects[i].id, 2U);  // all parts of an instance share one id
    }
    expect_near(at(s.objects[3].world_from_object, {}), {4, 0, -5});
    expect_near(at(s.objects[4].world_from_object, {}), {0, 2, -5});
    EXPECT_EQ(s.objects[3].material, 0U);
    EXPECT_EQ(s.objects[4].material, 1U);
    EXPECT_FALSE(s.objects[3].casts_shadows);
    EXPECT_TRUE(s.objects[4].casts_shadows);
    for (std::size_t i = 5; i <= 7; ++i) {
        EXPECT_EQ(s.objects[i].id, 3U);
        EXPECT_EQ(s.objects[i].material, 1U);
        EXPECT_TRUE(s.objects[i].casts_shadows);
        EXPECT_EQ(s.objects[i].keys.size(), 2U);
    }
}

TEST_F(TomlText, InstancesShareTheirMesh) {
    const Scene s = read(
        "[[object]]\nname = 'm'\nshape = 'mesh'\npositions_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = "
        "[[0, 1, 2]]\n"
        "[[object]]\nshape = 'instance'\nof = 'm'\ntranslate_m = [0, 0, 1]\n");
    EXPECT_EQ(std::get<std::shared_ptr<const Mesh>>(s.objects.at(0).shape),
              std::get<std::shared_ptr<const Mesh>>(s.objects.at(1).shape));
}

TEST_F(TomlText, CameraKeys) {
    const Camera c = camera(
        "name = 'c'\nposition_m = [1, 2, 3]\nlook_at_m = [4, 5, 6]\nup = [0, 0, 2]\nfilm_width_mm = "
        "24\nfocal_length_mm = 85\n"
        "width_px = 100\nheight_px = 50\nf_number = 2.8\nfocus_m = 4\nexposure_s = 0.02\n"
        "keys = [{ time_s = 0 }, { time_s = 1, translate_m = [1, 0, 0], quaternion = [1, 0, 0, 0] }]\n");
    EXPECT_EQ(c.name, "c");
    EXPECT_EQ(c.position, dvec3(1, 2, 3));
    EXPECT_EQ(c.look_at, dvec3(4, 5, 6));
    EXPECT_EQ(c.up, dvec3(0, 0, 1));
    EXPECT_EQ(c.film_width_mm, 24);
    EXPECT_EQ(c.focal_length_mm, 85);
    EXPECT_EQ(c.width, 100);
    EXPECT_EQ(c.height, 50);
    EXPECT_EQ(c.f_number, 2.8);
    EXPECT_EQ(c.focus_m, 4);
    EXPECT_EQ(c.exposure_s, 0.02);
    EXPECT_EQ(c.keys.at(1).translation, dvec3(1, 0, 0));
    const Camera wide =
        camera("horizontal_fov_degrees = 90\nlook_along = [0, 0, 3]\nf_number = inf\nfocus_m = inf\n");
    EXPECT_EQ(wide.horizontal_fov_degrees, 90);
    EXPECT_FALSE(wide.focal_length_mm);
    EXPECT_EQ(wide.look_at, dvec3(0, 0, 1));
    EXPECT_EQ(wide.f_number, std::numeric_limits<double>::infinity());
    EXPECT_EQ(wide.focus_m, std::numeric_limits<double>::infinity());
    EXPECT_EQ(camera("vertical_fov_degrees = 40\n").vertical_fov_degrees, 40);
    const Camera flat = camera("projection = 'orthographic'\northographic_width_m = 3\n");
    EXPECT_EQ(flat.projection, Camera::Projection::orthographic);
    EXPECT_EQ(flat.orthographic_width_m, 3);
    const Scene two = read(ball + "[[camera]]\nname = 'a'\n[[camera]]\nname = 'b'\n");
    EXPECT_EQ(two.cameras.at(0).name, "a");
    EXPECT_EQ(two.cameras.at(1).name, "b");
}

TEST_F(TomlText, LightKeys) {
    const Light p = light(
        "name = 'l'\nkind = 'point'\nposition_m = [1, 2, 3]\nintensity = [1, 2, 3]\nattenuation = [1, 2, 4]\n"
        "casts_shadows = false\nkeys = [{ time_s = 0 }, { time_s = 1, translate_m = [0, 0, 1] }]\n");
    EXPECT_EQ(p.kind, Light::Kind::point);
    EXPECT_EQ(p.name, "l");
    EXPECT_EQ(p.position, dvec3(1, 2, 3));
    EXPECT_EQ(p.intensity, dvec3(1, 2, 3));
    EXPECT_EQ(p.attenuation, dvec3(1, 2, 4));
    EXPECT_FALSE(p.casts_shadows);
    EXPECT_EQ(p.keys.size(), 2U);
    const Light d = light("kind = 'directional'\ndirection = [0, -2, 0]\n");
    EXPECT_EQ(d.kind, Light::Kind::directional);
    EXPECT_EQ(d.direction, dvec3(0, -1, 0));
    const Light s = light(
        "kind = 'spot'\nposition_m = [1, 2, 3]\ndirection = [0, 0, -1]\ncone_degrees = 40\ncone_soft_degrees "
        "= 20\n");
    EXPECT_EQ(s.kind, Light::Kind::spot);
    EXPECT_EQ(s.cone_degrees, 40);
    EXPECT_EQ(s.cone_soft_degrees, 20);
    const Light hard = light("kind = 'spot'\nposition_m = [1, 2, 3]\ndirection = [0, 0, -1]\n");
    EXPECT_EQ(hard.cone_degrees, 30);
    EXPECT_EQ(hard.cone_soft_degrees, 30);
}

TEST_F(TomlText, EveryLengthFollowsTheUnit) {
    const SceneReadOptions centimetres{.metres_per_unit = 0.01};
    const Camera c = camera(
        "position_m = [1, 0, 0]\nlook_at_m = [0, 0, -2]\nfocus_m = 300\nfilm_width_mm = 24\n"
        "keys = [{ time_s = 0, translate_m = [100, 0, 0] }]\n",
        centimetres);
    EXPECT_EQ(c.position, dvec3(0.01, 0, 0));
    EXPECT_EQ(c.look_at, dvec3(0, 0, -0.02));
    EXPECT_EQ(c.focus_m, 3);
    EXPECT_EQ(c.film_width_mm, 24);
    EXPECT_EQ(c.keys[0].translation, dvec3(1, 0, 0));
    EXPECT_EQ(
        camera("projection = 'orthographic'\northographic_width_m = 50\n", centimetres).orthographic_width_m,
        0.5);
    const Light l = light("kind = 'point'\nposition_m = [100, 0, 0]\nattenuation = [1, 1, 1]\n", centimetres);
    EXPECT_EQ(l.position, dvec3(1, 0, 0));
    expect_near(l.attenuation / dvec3(1, 100, 10000), dvec3(1));  // 1 m is 100 units away
    const Object o =
        object("shape = 'sphere'\nradius_m = 5\ntranslate_m = [100, 0, 0]\nscale = 2\n", centimetres);
    EXPECT_EQ(std::get<Sphere>(o.shape).radius, 0.05);
    expect_near(at(o.world_from_object, {1, 0, 0}), {3, 0, 0});
    expect_near(
        at(object("shape = 'sphere'\nradius_m = 5\nmatrix = [[1, 0, 0, 100], [0, 1, 0, 0], [0, 0, 1, 0]]\n",
                  centimetres)
               .world_from_object,
           {1, 0, 0}),
        {2, 0, 0});
    const Scene s = read(ball + "repeat = { count = 2, step_m = [100, 0, 0] }\n", centimetres);
    expect_near(at(s.objects.at(1).world_from_object, {}), {1, 0, 0});
    const Object triangle =
        object("shape = 'mesh'\npositions_m = [[0, 0, 0], [100, 0, 0], [0, 100, 0]]\nfaces = [[0, 1, 2]]\n",
               centimetres);
    const Mesh& m = *std::get<std::shared_ptr<const Mesh>>(triangle.shape);
    EXPECT_EQ(m.positions.at(1), glm::vec3(1, 0, 0));
}

TEST_F(TomlText, WhatIsMissingIsMadeAndSaid) {
    const Scene s = read(ball);
    ASSERT_EQ(s.cameras.size(), 1U);
    ASSERT_EQ(s.lights.size(), 1U);
    EXPECT_EQ(s.lights[0].position, s.cameras[0].position);
    ASSERT_EQ(s.notes.size(), 2U);
    EXPECT_EQ(s.notes[0].rfind("no camera in the scene: made one of 50 mm", 0), 0U);
    EXPECT_EQ(s.notes[1], "no light in the scene: made one of intensity 1 at the eye");
    // No default light is added if lights have no effect, or if the file states that there are none.
    EXPECT_TRUE(read("[[material]]\nname = 'm'\ndiffuse = 0\n[[camera]]\n" + ball + "material = 'm'\n")
                    .lights.empty());
    EXPECT_TRUE(read("light = []\n[[camera]]\n" + ball).notes.empty());
    const Scene flat = read(
        "[[camera]]\nprojection = 'orthographic'\northographic_width_m = 2\nlook_along = [1, 0, 0]\n" + ball);
    EXPECT_EQ(flat.lights.at(0).kind, Light::Kind::directional);
    EXPECT_EQ(flat.lights.at(0).direction, dvec3(1, 0, 0));
    EXPECT_EQ(read("[[object]]\nshape = 'plane'\nnormal = [0, 1, 0]\n").cameras.size(), 1U);
}

TEST_F(TomlText, UnknownKeysNameTheNearestKnownOne) {
    EXPECT_EQ(error("[[objects]]\n"),
              "1:3: scene file: unknown key (got 'objects'; nearest known key: 'object')");
    EXPECT_EQ(error("[scene]\nbackgruond = 1\n"),
              "2:1: [scene]: unknown key (got 'backgruond'; nearest known key: 'background')");
    EXPECT_EQ(error("[[material]]\nname = 'm'\ncolor = 1\n"),
              "3:1: material 'm': unknown key (got 'color'; nearest known key: 'colour')");
    EXPECT_EQ(error("[[texture]]\nname = 't'\nkind = 'checker'\nsize = 1\n"),
              "4:1: texture 1: unknown key (got 'size'; nearest known key: 'size_m')");
    EXPECT_EQ(error("[[texture]]\nname = 't'\nkind = 'checker'\nsize_m = 1\nfile = 'x'\n"),
              "5:1: texture 't': unknown key (got 'file'; nearest known key: 'name')");
    EXPECT_EQ(error("[[camera]]\nfocal_lenght_mm = 3\n" + ball),
              "2:1: camera 1: unknown key (got 'focal_lenght_mm'; nearest known key: 'focal_length_mm')");
    EXPECT_EQ(error("[[light]]\nkin = 'point'\n" + ball),
              "2:1: light 1: unknown key (got 'kin'; nearest known key: 'kind')");
    EXPECT_EQ(error(ball + "[[light]]\nkind = 'point'\nposition_m = [0, 0, 0]\ncone_degrees = 3\n")
                  .rfind("7:1: light 1: unknown key", 0),
              0U);
    EXPECT_EQ(ball_error("raduis_m = 2"),
              "4:1: object 'sphere 1': unknown key (got 'raduis_m'; nearest known key: 'radius_m')");
    EXPECT_EQ(ball_error("  size_m = 2").rfind("4:3: object 'sphere 1': unknown key (got 'size_m'", 0), 0U);
    EXPECT_EQ(error("[[object]]\nshpae = 'sphere'\n"),
              "2:1: object 1: unknown key (got 'shpae'; nearest known key: 'shape')");
    EXPECT_EQ(
        ball_error("keys = [{ time_s = 0, tranlate_m = [0, 0, 0] }]"),
        "4:23: object 'sphere 1': key 1: unknown key (got 'tranlate_m'; nearest known key: 'translate_m')");
    EXPECT_EQ(ball_error("repeat = { cuont = 2 }"),
              "4:12: object 'sphere 1': repeat: unknown key (got 'cuont'; nearest known key: 'count')");
    // The first unknown key in the order of the file is reported.
    EXPECT_EQ(ball_error("zzz = 1\naaa = 2").rfind("4:1: object 'sphere 1': unknown key (got 'zzz'", 0), 0U);
}

TEST_F(TomlText, UnknownWordsNameTheNearestKnownOne) {
    EXPECT_EQ(error("[[object]]\nshape = 'sphrere'\n"),
              "2:9: object 1: 'shape' is unknown (got 'sphrere'; nearest known: 'sphere'; expected one of "
              "sphere, box, disc, "
              "rectangle, plane, cylinder, cone, mesh, instance)");
    EXPECT_EQ(error("[[material]]\nname = 'clay'\n" + ball + "material = 'claz'\n"),
              "6:12: object 'sphere 1': no material has this name (got 'claz'; nearest known name: 'clay')");
    EXPECT_EQ(ball_error("material = 'clay'"),
              "4:12: object 'sphere 1': no material has this name (got 'clay'; the scene has none)");
    EXPECT_EQ(error("[[material]]\nname = 'm'\ncolour_texture = 'x'\n"),
              "3:18: material 'm': no texture has this name (got 'x'; the scene has none)");
    EXPECT_EQ(error(ball + "name = 'b'\n[[object]]\nshape = 'instance'\nof = 'c'\n"),
              "7:6: object 'instance 2': no object above has this name (got 'c'; nearest known name: 'b'); "
              "an instance stands "
              "below what it repeats");
    EXPECT_EQ(error("[[light]]\nkind = 'sport'\n" + ball),
              "2:8: light 1: 'kind' is unknown (got 'sport'; nearest known: 'spot'; expected one of point, "
              "directional, spot, sphere, rectangle)");
}

TEST_F(TomlText, MissingKeysAreNamed) {
    EXPECT_EQ(error("[[object]]\nname = 'x'\n"), "1:1: object 1: has no 'shape' (expected one)");
    EXPECT_EQ(error("\n[[object]]\nshape = 'sphere'\n"),
              "2:1: object 'sphere 1': has no 'radius_m' (expected one)");
    EXPECT_EQ(error("[[object]]\nshape = 'instance'\n"),
              "1:1: object 'instance 1': has no 'of' (expected one)");
    EXPECT_EQ(error("[[material]]\nior = 1\n"), "1:1: material 1: has no 'name' (expected one)");
    EXPECT_EQ(error("[[texture]]\nname = 't'\n"), "1:1: texture 't': has no 'kind' (expected one)");
    EXPECT_EQ(error(ball + "[[light]]\n"), "4:1: light 1: has no 'kind' (expected one)");
    EXPECT_EQ(ball_error("keys = [{ translate_m = [0, 0, 0] }]"),
              "4:9: object 'sphere 1': key 1: has no 'time_s' (expected one)");
    EXPECT_EQ(ball_error("repeat = { step_m = [0, 0, 0] }"),
              "4:10: object 'sphere 1': repeat: has no 'count' (expected one)");
    EXPECT_EQ(ball_error("repeat = { count = 2 }"),
              "4:10: object 'sphere 1': repeat: has no 'step_m' (expected one)");
}

TEST_F(TomlText, WrongTypesAreNamed) {
    EXPECT_EQ(error("[[object]]\nshape = 'sphere'\nradius_m = 'big'\n"),
              "3:12: object 'sphere 1': 'radius_m' is a text (got 'big'; expected a number)");
    EXPECT_EQ(ball_error("translate_m = 1"),
              "4:15: object 'sphere 1': 'translate_m' is a number (got 1; expected an array of 3 numbers)");
    EXPECT_EQ(ball_error("translate_m = [1, 2]"),
              "4:15: object 'sphere 1': 'translate_m' has the wrong length (got 2; expected 3 numbers)");
    EXPECT_EQ(ball_error("translate_m = [1, true, 2]"),
              "4:19: object 'sphere 1': 'translate_m' is true or false (got true; expected a number)");
    EXPECT_EQ(ball_error("scale = 'x'"),
              "4:9: object 'sphere 1': 'scale' is a text (got 'x'; expected a number or 3 numbers)");
    EXPECT_EQ(ball_error("hidden = 1"),
              "4:10: object 'sphere 1': 'hidden' is a number (got 1; expected true or false)");
    EXPECT_EQ(ball_error("name = 2024-01-01"),
              "4:8: object 1: 'name' is a date or time (got a date or time; expected a text)");
    EXPECT_EQ(ball_error("name = ''"),
              "4:8: object 1: 'name' is not a usable text (got ''; expected 1 to 255 printable characters)");
    EXPECT_EQ(
        ball_error("name = \"a\\u0007\"").rfind("4:8: object 1: 'name' is not a usable text (got 'a?'", 0),
        0U);
    EXPECT_EQ(ball_error("keys = 3"),
              "4:8: object 'sphere 1': 'keys' is a number (got 3; expected an array of tables)");
    EXPECT_EQ(ball_error("keys = [3]"),
              "4:9: object 'sphere 1': 'keys' holds a number (got 3; expected tables)");
    EXPECT_EQ(ball_error("repeat = 3"),
              "4:10: object 'sphere 1': 'repeat' is a number (got 3; expected a table)");
    EXPECT_EQ(error("object = 1\n"),
              "1:10: scene file: 'object' is a number (got 1; expected an array of tables)");
    EXPECT_EQ(error("scene = 1\n"), "1:9: scene file: 'scene' is a number (got 1; expected a table)");
    EXPECT_EQ(error("[[camera]]\nwidth_px = 1.5\n" + ball),
              "2:12: camera 1: 'width_px' is not whole (got 1.5; expected a whole number)");
}

TEST_F(TomlText, NumbersOutOfRangeAreRefused) {
    const std::string start = "[[object]]\nshape = 'sphere'\nradius_m = ";
    const std::string range = "; expected 1e-12 to 1e+12)";
    for (const auto& [text, shown] :
         {std::pair("0", "0"), std::pair("-1", "-1"), std::pair("inf", "inf"), std::pair("nan", "nan"),
          std::pair("1e300", "1e+300"), std::pair("1e-300", "1e-300")}) {
        EXPECT_EQ(error(start + text + "\n"),
                  std::string("3:12: object 'sphere 1': 'radius_m' is out of range (got ") + shown + range);
    }
    EXPECT_EQ(ball_error("translate_m = [0, nan, 0]"),
              "4:19: object 'sphere 1': 'translate_m' is out of range (got nan; expected -1e+12 to 1e+12)");
    EXPECT_EQ(ball_error("scale = 0"),
              "4:9: object 'sphere 1': 'scale' is out of range (got 0; expected 1e-09 to 1e+09)");
    EXPECT_EQ(
        ball_error("scale = [1, -1, 1]").rfind("4:13: object 'sphere 1': 'scale' is out of range (got -1", 0),
        0U);
    EXPECT_EQ(error("[[material]]\nname = 'm'\nreflection = 1.5\n"),
              "3:14: material 'm': 'reflection' is out of range (got 1.5; expected 0 to 1)");
    EXPECT_EQ(error("[[material]]\nname = 'm'\nemission = [1, 2, -3]\n"),
              "3:19: material 'm': 'emission' is out of range (got -3; expected 0 to 1e+12)");
    EXPECT_EQ(error("[[material]]\nname = 'm'\nior = 0\n"),
              "3:7: material 'm': 'ior' is out of range (got 0; expected 0.01 to 100)");
    EXPECT_EQ(error("[scene]\ntime_s = inf\n").rfind("2:10: [scene]: 'time_s' is out of range (got inf", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nf_number = 0\n" + ball),
              "2:12: camera 1: 'f_number' is out of range (got 0; expected 0.001 to 1e+06 or inf)");
    EXPECT_EQ(error("[[camera]]\nfocus_m = -1\n" + ball)
                  .rfind("2:11: camera 1: 'focus_m' is out of range (got -1", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nheight_px = 0\n" + ball),
              "2:13: camera 1: 'height_px' is out of range (got 0; expected 1 to 65536)");
    EXPECT_EQ(error("[[camera]]\nvertical_fov_degrees = 180\n" + ball),
              "2:24: camera 1: 'vertical_fov_degrees' is out of range (got 180; expected 0.001 to 179)");
    EXPECT_EQ(error(ball + "scale = 1e9\ntranslate_m = [9e11, 0, 0]\n[[object]]\nshape = 'sphere'\nradius_m "
                           "= 1e6\nscale = 1e9\n"),
              " object 'sphere 2' reaches too far (expected at most 1000000000000 m from the origin)");
    EXPECT_EQ(ball_error("repeat = { count = [1000, 1000, 1000], step_m = [1, 1, 1] }"),
              "4:20: object 'sphere 1': repeat: 'count' makes too many copies (got 1000000000; expected at "
              "most 1000000)");
    EXPECT_EQ(ball_error("repeat = { count = [1.5, 1, 1], step_m = [1, 1, 1] }"),
              "4:20: object 'sphere 1': repeat: 'count' is not whole (got 1.5; expected whole numbers)");
    EXPECT_EQ(ball_error("repeat = { at_m = [] }"),
              "4:19: object 'sphere 1': repeat: 'at_m' is empty (expected at least one place)");
}

TEST_F(TomlText, ContradictionsAreRefused) {
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]\nscale = 2"),
              "5:9: object 'sphere 1': 'matrix' and 'scale' cannot stand together (expected one of them)");
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' flattens or mirrors", 0),
              0U);
    EXPECT_EQ(ball_error("matrix = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' flattens or mirrors", 0),
              0U);
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' is not affine (got 1 rows", 0),
              0U);
    EXPECT_EQ(ball_error("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]")
                  .rfind("4:10: object 'sphere 1': 'matrix' is not affine", 0),
              0U);
    EXPECT_EQ(ball_error("rotate_degrees = 10"),
              "4:18: object 'sphere 1': one angle needs 'rotate_axis' (expected it, or three angles about x, "
              "y, z)");
    EXPECT_EQ(ball_error("rotate_axis = [0, 0, 1]"),
              "4:15: object 'sphere 1': 'rotate_axis' needs 'rotate_degrees' (expected both or neither)");
    EXPECT_EQ(ball_error("rotate_degrees = [1, 2, 3]\nrotate_axis = [0, 0, 1]")
                  .rfind("5:15: object 'sphere 1': 'rotate_axis' stands beside", 0),
              0U);
    EXPECT_EQ(ball_error("rotate_degrees = 1\nrotate_axis = [0, 0, 0]")
                  .rfind("5:15: object 'sphere 1': 'rotate_axis' has no direction", 0),
              0U);
    EXPECT_EQ(ball_error("quaternion = [0, 0, 0, 0]")
                  .rfind("4:14: object 'sphere 1': 'quaternion' has no length", 0),
              0U);
    EXPECT_EQ(ball_error("hidden = true"),
              "4:10: object 'sphere 1': a hidden object without a name can never be seen");
    EXPECT_EQ(error(ball + "name = 'b'\nhidden = true\n"),
              " the scene has no objects (expected at least one that is not hidden)");
    EXPECT_EQ(error(ball + "name = 'b'\n" + ball + "name = 'b'\n"),
              "8:8: object 'b': two objects have the name 'b'");
    EXPECT_EQ(error("[[material]]\nname = 'm'\n[[material]]\nname = 'm'\n"),
              "4:8: material 'm': two materials have the name 'm'");
    EXPECT_EQ(error("[[camera]]\nname = 'm'\n[[camera]]\nname = 'm'\n" + ball),
              "4:8: camera 'm': two of a kind have the name 'm'");
    EXPECT_EQ(error("[[camera]]\nfocal_length_mm = 50\nvertical_fov_degrees = 20\n" + ball),
              "3:24: camera 1: 'focal_length_mm' and 'vertical_fov_degrees' cannot stand together (expected "
              "one of them)");
    EXPECT_EQ(error("[[camera]]\northographic_width_m = 2\n" + ball)
                  .rfind("2:24: camera 1: 'orthographic_width_m' has no meaning", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nprojection = 'orthographic'\nfocal_length_mm = 2\n" + ball)
                  .rfind("3:19: camera 1: 'focal_length_mm' has no meaning", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nlook_at_m = [0, 0, 0]\n" + ball)
                  .rfind("1:1: camera 1: 'position_m', the view's direction and 'up' do not span", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nlook_along = [0, 1, 0]\n" + ball)
                  .rfind("1:1: camera 1: 'position_m', the view's direction and 'up' do not span", 0),
              0U);
    EXPECT_EQ(error("[[camera]]\nkeys = [{ time_s = 0, scale = 2 }]\n" + ball)
                  .rfind("2:23: camera 1: key 1: unknown key (got 'scale'", 0),
              0U);
    EXPECT_EQ(
        error(ball + "[[light]]\nkind = 'spot'\nposition_m = [0, 0, 0]\ndirection = [0, 0, 1]\ncone_degrees "
                     "= 20\ncone_soft_degrees = 30\n"),
        "9:21: light 1: 'cone_soft_degrees' is out of range (got 30; expected at most 'cone_degrees', 20)");
    EXPECT_EQ(error(ball + "[[light]]\nkind = 'point'\nposition_m = [0, 0, 0]\nattenuation = [0, 0, 0]\n")
                  .rfind("7:15: light 1: 'attenuation' is 0 everywhere", 0),
              0U);
}

TEST_F(TomlText, ShapesWithoutExtentAreRefused) {
    const auto shape = [&](const std::string& keys) { return error("[[object]]\nshape = " + keys + "\n"); };
    EXPECT_EQ(shape("'box'\nmin_m = [0, 0, 0]\nmax_m = [1, 0, 1]"),
              "4:9: object 'box 1': 'max_m' does not exceed 'min_m' on every axis (got a size of 1, 0, 1 m)");
    EXPECT_EQ(shape("'box'\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\nsize_m = 1"),
              "5:10: object 'box 1': 'min_m' and 'size_m' cannot stand together (expected one of them)");
    EXPECT_EQ(shape("'disc'\nnormal = [0, 0, 1]\nradius_m = 1\ninner_radius_m = 1"),
              "5:18: object 'disc 1': 'inner_radius_m' is out of range (got 1 m; expected less than "
              "'radius_m', 1 m)");
    EXPECT_EQ(shape("'rectangle'\ncorner_m = [0, 0, 0]\nedge_u_m = [1, 0, 0]\nedge_v_m = [2, 0, 0]"),
              "1:1: object 'rectangle 1': 'edge_u_m' and 'edge_v_m' span no area (expected two edges of "
              "different directions)");
    EXPECT_EQ(shape("'cylinder'\nbase_m = [0, 0, 0]\napex_m = [0, 0, 0]\nradius_m = 1"),
              "4:10: object 'cylinder 1': 'apex_m' and 'base_m' coincide (expected a distance between them)");
    EXPECT_EQ(shape("'cone'\nbase_m = [0, 0, 0]\napex_m = [0, 0, 1]\nbase_radius_m = 0"),
              "5:17: object 'cone 1': both radii are 0 (expected one above)");
    EXPECT_EQ(
        shape("'plane'\nnormal = [0, 0, 0]").rfind("3:10: object 'plane 1': 'normal' has no direction", 0),
        0U);
}

TEST_F(TomlText, MeshErrorsNameTheFace) {
    const auto mesh = [&](const std::string& keys) {
        return error("[[object]]\nshape = 'mesh'\npositions_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n" + keys +
                     "\n");
    };
    EXPECT_EQ(
        mesh("faces = [[0, 1, 3]]"),
        "4:9: object 'mesh 1': face 0 has an index out of range (got 3; expected a whole number of 0 to 2)");
    EXPECT_EQ(mesh("faces = [[0, 1, -1]]")
                  .rfind("4:9: object 'mesh 1': face 0 has an index out of range (got -1", 0),
              0U);
    EXPECT_EQ(mesh("faces = [[0, 1, 1.5]]")
                  .rfind("4:9: object 'mesh 1': face 0 has an index out of range (got 1.5", 0),
              0U);
    EXPECT_EQ(mesh("faces = [[0, 1, 2], [0, 1, 1]]"),
              "4:9: object 'mesh 1': face 1 has no area (expected a simple polygon)");
    EXPECT_EQ(mesh("faces = [[0, 1]]"),
              "4:10: object 'mesh 1': a row of 'faces' has the wrong length (got 2; expected 3 to 4096)");
    EXPECT_EQ(mesh("faces = []"), "4:9: object 'mesh 1': the mesh is empty (expected positions and faces)");
    EXPECT_EQ(mesh("faces = [[0, 1, 2]]\nnormals = [[0, 0, 1]]"),
              "5:11: object 'mesh 1': 'normals' has the wrong length (got 1; expected one per position, 3)");
    EXPECT_EQ(mesh("faces = [[0, 1, 2]]\nuvs = [[0, 0, 1]]"),
              "5:8: object 'mesh 1': a row of 'uvs' has the wrong length (got 3; expected 2)");
    EXPECT_EQ(mesh("faces = [[0, 1, 2]]\nnormals = [[0, 0, 1], [0, 0, 0], [0, 0, 1]]"),
              "5:11: object 'mesh 1': a normal has no length (got 0, 0, 0)");
}

TEST_F(TomlText, MotionErrors) {
    EXPECT_EQ(ball_error("keys = [{ time_s = 1 }, { time_s = 1 }]"),
              "4:36: object 'sphere 1': key 2: 'time_s' does not grow (got 1 s after 1 s)");
    EXPECT_EQ(
        ball_error("keys = [{ time_s = 0 }, { time_s = 1, rotate_degrees = 360, rotate_axis = [0, 1, 0] }]"),
        "4:25: object 'sphere 1': key 2: the turn since the key before is ambiguous (got 360 degrees; "
        "expected less than "
        "180: add a key between)");
    EXPECT_EQ(ball_error("keys = [{ time_s = 0 }, { time_s = 1, rotate_degrees = [0, 179, 0] }]"),
              "no error");
    EXPECT_EQ(error(ball + "name = 'b'\nkeys = [{ time_s = 0 }]\n[[object]]\nshape = 'instance'\nof = 'b'\n"),
              "8:6: object 'instance 2': 'b' moves and cannot be instanced (expected 'keys' on the instance "
              "instead)");
}

TEST_F(TomlText, FresnelIsAskedForAndMakesNoMirrorOfWhatIsNone) {
    EXPECT_FALSE(material("reflection = 0.04").fresnel);
    const Material m = material("reflection = 0.04\nfresnel = true");
    EXPECT_TRUE(m.fresnel);
    EXPECT_EQ(m.reflection_grazing, dvec3(1));
    EXPECT_FALSE(m.has_highlight());
    EXPECT_FALSE(material("specular = 0.3\nfresnel = true").reflects());
    EXPECT_NE(error(ball + "material = 'm'\n[[material]]\nname = 'm'\nfresnel = 1\n").find("fresnel"),
              std::string::npos);
}

TEST_F(TomlText, InstancesOfInstancesCannotGrowWithoutBound) {
    std::string text = ball + "name = 'o0'\nhidden = true\n";
    for (int i = 1; i < 12; ++i) {
        const std::string below = "'o" + std::to_string(i - 1) + "'";
        text += "[[object]]\nshape = 'instance'\nhidden = true\nname = 'o" + std::to_string(i) + "'\nof = [" +
                below + ", " + below + ", " + below + ", " + below + ", " + below + ", " + below + ", " +
                below + ", " + below + "]\n";
    }
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(error(text).find("the scene has too many shapes"), std::string::npos);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(TomlText, SyntaxErrorsHaveLineAndColumn) {
    EXPECT_EQ(error("[scene\n").rfind("1:7: not valid TOML: ", 0), 0U);
    EXPECT_EQ(error("a = 1\na = 2\n").rfind("2:5: not valid TOML: ", 0), 0U);
    EXPECT_EQ(error("[scene]\nname = 'open\n").rfind("2:", 0), 0U);
    EXPECT_EQ(error("x = \xFF\xFE\n").find("not valid TOML") != std::string::npos, true);
    EXPECT_EQ(error("x = " + std::string(100000, '[')).find("not valid TOML") != std::string::npos, true);
    EXPECT_EQ(error(""), " the scene has no objects (expected at least one that is not hidden)");
}

TEST_F(TomlText, EveryTruncationIsAnErrorOrAScene) {
    const std::string text =
        "[scene]\nname = 'x'\n[[material]]\nname = 'm'\ndiffuse = [1, 0.5, 0]\n" + ball +
        "material = 'm'\nkeys = [{ time_s = 0 }, { time_s = 1.5, translate_m = [0, 1, 0] }]\n";
    int errors = 0;
    for (std::size_t length = 0; length < text.size(); ++length) {
        errors += error(text.substr(0, length)) == "no error" ? 0 : 1;
    }
    EXPECT_GT(errors, 100);
}

TEST_F(TomlText, LargeGarbageFailsAtOnce) {
    const auto start = std::chrono::steady_clock::now();
    std::ofstream(path_, std::ios::binary) << "x = 1\n";
    std::filesystem::resize_file(path_, 100'000'000);
    EXPECT_THROW(std::ignore = read_scene(path_), Error);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
    std::filesystem::resize_file(path_,
                                 largest_toml_bytes);  // small enough to be parsed, but filled with zeros
    EXPECT_THROW(std::ignore = read_scene(path_), Error);
}

TEST(SampleScenes, AreReadWithoutNotes) {
    for (const char* name : {"still_life", "bars", "ruler", "night"}) {
        const Scene s = read_scene(samples / (std::string(name) + ".toml"));
        EXPECT_TRUE(s.notes.empty()) << name << ": " << s.notes.front();
        ASSERT_EQ(s.cameras.size(), 1U) << name;
        EXPECT_EQ(s.cameras[0].focal_length_mm, 50) << name;
        EXPECT_EQ(s.cameras[0].f_number, 1.4) << name;
        EXPECT_TRUE(s.cameras[0].focus_m) << name;
        EXPECT_EQ(s.cameras[0].width, 960) << name;
        EXPECT_EQ(s.cameras[0].height, 540) << name;
        std::set<std::uint32_t> ids;
        for (const Object& o : s.objects) ids.insert(o.id);
        EXPECT_EQ(ids.size(), s.objects.size()) << name;
    }
}

TEST(SampleScenes, BarsOnlyShines) {
    const Scene s = read_scene(samples / "bars.toml");
    EXPECT_TRUE(s.lights.empty());
    for (const Material& m : s.materials) {
        EXPECT_EQ(m.ambient + m.diffuse + m.diffuse_transmission + m.specular + m.reflection + m.transmission,
                  dvec3(0));
        EXPECT_NE(m.emission, dvec3(0));
    }
}

TEST(SampleScenes, RulerMarksStandWhereTheySay) {
    const Scene s = read_scene(samples / "ruler.toml");
    int marks = 0;
    for (const Object& o : s.objects) {
        if (o.name.rfind("mark[", 0) != 0) continue;
        const Rectangle& r = std::get<Rectangle>(o.shape);
        const double depth = -at(o.world_from_object, r.corner + 0.5 * r.edge_u).z;
        EXPECT_NEAR(depth, 1.4 + 0.1 * marks, 1e-3);
        ++marks;
    }
    EXPECT_EQ(marks, 20);
}

}  // namespace
}  // namespace postlens
