// The .toml scene format: all keys of the scene, materials, cameras and lights, and the sample scenes.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <set>
#include <string>

#include "scene/file_digest.h"
#include "scene/scene.h"
#include "tests/scene/toml_text.h"

namespace postlens::test::toml_scene_test {
namespace {

using glm::dvec3;

const std::filesystem::path samples = std::filesystem::path(POSTLENS_SAMPLES) / "scenes";

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
              "4:8: texture 'i': " + here + "/none.png: cannot read (no such file)");
    EXPECT_EQ(error(start + "." + end).rfind("4:8: texture 'i': ", 0), 0U);
    std::ofstream(folder_.path() / "bad.png") << "no picture";
    EXPECT_EQ(error(start + "bad.png" + end).rfind("4:8: texture 'i': ", 0), 0U);
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
}  // namespace postlens::test::toml_scene_test
