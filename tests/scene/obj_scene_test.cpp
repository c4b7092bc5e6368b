// OBJ files: polygons, materials and the encoding of the text.
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <string>

#include "pictures/image.h"
#include "scene/mesh/mesh_files.h"
#include "scene/mesh/obj_text.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"
#include "tests/scene/mesh_text.h"

namespace postlens::test::obj_scene_test {
namespace {

using glm::dvec3;
using testing::HasSubstr;

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
    EXPECT_THAT(error("t.obj", "v 0 zero 0\n" + rest), HasSubstr("cannot read"));
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

TEST(ObjText, IsRewrittenAsAssimpReadsIt) {
    EXPECT_EQ(rewritten_obj("  v .5 -.5 +.5\r\n\tvt .25\t.75 \nf 1 2 3 # f .5\n"),
              "v 0.5 -.5 +.5\r\nvt 0.25\t0.75\nf 1 2 3\n");
    // Continued lines are one statement, comments and names stay as they are.
    EXPECT_EQ(rewritten_obj("f 1 2 \\\n  3 # a \\\n 4\nf 1 2 3"), "f 1 2 \\\n  3\nf 1 2 3");
    EXPECT_EQ(rewritten_obj("v 1 \\\n.5 0\n# v .5\no a #1 .5\nusemtl .5 \n"),
              "v 1 \\\n0.5 0\n# v .5\no a #1 .5\nusemtl .5\n");
    EXPECT_EQ(rewritten_obj("v . 0 1.\n\n \nv 1.#INF 0 0\n"), "v . 0 1.\n\n\nv 1.#INF 0 0\n");
    EXPECT_EQ(rewritten_obj("g a\\ \nv 1 0 0\n"), "g a\\ \nv 1 0 0\n");
    EXPECT_EQ(rewritten_obj("mtllib my a.mtl B.MTL  \n"), "mtllib my a.mtl\nmtllib B.MTL\n");
    EXPECT_EQ(rewritten_obj("mtllib a.mtl # all of it\nmtllib\n"), "mtllib a.mtl\n\n");
}

TEST(ObjText, OptionsOfPicturesAreTakenOff) {
    std::map<std::string, MaterialPictures> pictures;
    SceneNotes notes;
    EXPECT_EQ(
        rewritten_mtl("newmtl a b \n Kd .5 1 1 # red\nd -halo .5 # half\nillum 2\nmap_Kd -s 4 .5 1 -o 1 "
                      "-clamp on -mm 0 1 2.png\nmap_Ke -s 3 4.png\nbump -s 1 1 1 b.png\nmap_Kd\n",
                      pictures, notes),
        "newmtl a b\nKd .5 1 1\nd .5\nillum 2\nmap_kd 2.png\nmap_ke 4.png\nbump -s 1 1 1 b.png\n\n");
    const MaterialPictures& of = pictures.at("a b");
    EXPECT_EQ(of.colour.scale, glm::dvec2(1));  // the last statement has no options
    EXPECT_EQ(of.emission.scale, glm::dvec2(3, 1));
}

TEST_F(MeshText, ObjNumbersMayBeginWithTheirPoint) {
    const std::string faces = "f 1 2 3\nf 1 3 4\n";
    const Scene s = read("t.obj", "v -.5 -.5 0\nv .5 -.5 0\nv .5 .5 0\nv -.5 .5 0\nv -5 -5 0\n" + faces);
    ASSERT_EQ(triangles(s), 2U);
    for (const glm::vec3& p : mesh_of(s.objects.at(0)).positions) {
        EXPECT_EQ(glm::abs(p), glm::vec3(0.5F, 0.5F, 0));
    }
    const Scene t = read("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt .5 .25\nf 1/1 2/1 3/1\n");
    EXPECT_EQ(mesh_of(t.objects.at(0)).uvs.at(0), glm::vec2(0.5F, 0.25F));
}

TEST_F(MeshText, ObjLinesMayBeIndentedAndEndWithComments) {
    const Scene s = read("t.obj",
                         "  v 0 0 0 # 1 1 1\n\tv 1 0 0\nv 1 1 0\nv 0 1 0 # the last\nf 1 2 3 # half\n"
                         "  f 1 3 4\n");
    EXPECT_EQ(triangles(s), 2U);
    EXPECT_TRUE(mesh_of(s.objects.at(0)).colours.empty());
}

TEST_F(MeshText, MtlLibrariesMayBeSeveralOnALine) {
    write("a.mtl", "newmtl a\nKd 1 0 0\n");
    write("b.mtl", "newmtl b\nKd 0 1 0\n");
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const Scene both = read(
        "t.obj", "mtllib a.mtl b.mtl \t\n" + triangle + "o x\nusemtl a\nf 1 2 3\no y\nusemtl b\nf 1 3 2\n");
    ASSERT_EQ(both.objects.size(), 2U);
    EXPECT_EQ(both.materials.at(both.objects[0].material).diffuse, dvec3(1, 0, 0));
    EXPECT_EQ(both.materials.at(both.objects[1].material).diffuse, dvec3(0, 1, 0));
    EXPECT_EQ(both.referred.size(), 2U);
    EXPECT_FALSE(notes_have(both, "material library"));
    const Scene one = read("t.obj", "mtllib a.mtl c.mtl\n" + triangle + "usemtl a\nf 1 2 3\n");
    EXPECT_EQ(one.materials.at(one.objects.at(0).material).diffuse, dvec3(1, 0, 0));
    EXPECT_TRUE(notes_have(one, "the material library 'c.mtl' cannot be read"));
}

TEST_F(MeshText, MtlHaloIsReadAsPlainOpacity) {
    write("m.mtl", "newmtl a\nKd 1 1 1\nd -halo 0.25\n");
    const Scene s = read("t.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(s.materials.at(s.objects.at(0).material).diffuse, dvec3(0.25));
    EXPECT_TRUE(notes_have(s, "-halo"));
}

TEST_F(MeshText, MtlOptionsPlaceThePicture) {
    Image image(2, 1);
    image.rgb = {1, 0, 0, 0, 1, 0};
    write_image(folder_.path() / "two colours.png", image);
    const auto scene = [this](const std::string& mtl) {
        write("m.mtl", "newmtl a\nKd 1 1 1\n" + mtl);
        return read("t.obj",
                    "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0.5 1\nf 1/1 2/2 "
                    "3/3\n");
    };
    const Scene s = scene("map_Kd -s 4 2 1 -o 0.25 -1 0 two colours.png\n");
    const auto& uvs = mesh_of(s.objects.at(0)).uvs;
    ASSERT_EQ(uvs.size(), 3U);
    EXPECT_EQ(uvs[1], glm::vec2(4.25F, -1));
    EXPECT_EQ(uvs[2], glm::vec2(2.25F, 1));
    EXPECT_FALSE(notes_have(s, "picture"));
    // Texels are centred at u = 0.25 and 0.75. Beyond them a clamped picture has the colour of its edge.
    for (const bool clamp : {false, true}) {
        const Scene placed = scene(clamp ? "map_Kd -clamp on two colours.png\n" : "map_Kd two colours.png\n");
        const Material& m = placed.materials.at(placed.objects.at(0).material);
        ASSERT_TRUE(m.colour_texture);
        EXPECT_EQ(m.colour_texture->colour({}, {1.25, 0.5}), clamp ? dvec3(0, 1, 0) : dvec3(1, 0, 0));
    }
    EXPECT_TRUE(notes_have(scene("map_Kd -mm 0 2 two colours.png\n"), "the option '-mm' of a picture"));
    EXPECT_TRUE(notes_have(scene("map_Kd -s 2 2 2 two colours.png\nmap_Ke two colours.png\n"),
                           "the picture of Ke lies on the surface as that of Kd does"));
}

TEST(MeshFiles, TextIsMadeUtf8) {
    EXPECT_EQ(as_utf8("plain"), "plain");
    EXPECT_EQ(as_utf8("\xEF\xBB\xBFplain"), "plain");
    EXPECT_EQ(as_utf8(std::string("\xFF\xFE\x41\x00\xE4\x00", 6)), "A\xC3\xA4");
    EXPECT_EQ(as_utf8(std::string("\xFE\xFF\x00\x41\x20\xAC", 6)), "A\xE2\x82\xAC");
}

}  // namespace
}  // namespace postlens::test::obj_scene_test
