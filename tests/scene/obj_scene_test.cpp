// OBJ files: polygons, materials and the encoding of the text.
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

#include "scene/mesh/mesh_files.h"
#include "scene/scene.h"
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
    EXPECT_THAT(error("t.obj", "v 0 zero 0\n" + rest), HasSubstr("cannot be read"));
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

}  // namespace
}  // namespace postlens::test::obj_scene_test
