// Content of scene files that only distributed rays use: lights with an extent, lobes of glossy materials.
#include <fstream>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::spread_scene_test {
namespace {

const std::string ball = "\n[[object]]\nshape = 'sphere'\nradius_m = 1\n";

Scene read(const std::string& text, double metres_per_unit = 1) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "scene.toml";
    std::ofstream(path) << text;
    return read_scene(path, {.metres_per_unit = metres_per_unit});
}

// The error message after the file's name.
std::string error(const std::string& text) {
    try {
        read(text);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::invalid_input);
        const std::string what = e.what();
        return what.substr(what.find("scene.toml:") + 11);
    }
    return "no error";
}

TEST(SpreadScene, SphereLightsHaveARadius) {
    const Scene s = read("[[light]]\nkind = 'sphere'\nposition_m = [1, 2, 3]\nradius_m = 0.5\n" + ball, 0.1);
    const Light& l = s.lights.at(0);
    EXPECT_EQ(l.kind, Light::Kind::sphere);
    EXPECT_TRUE(l.has_extent());
    EXPECT_DOUBLE_EQ(l.radius, 0.05);
    EXPECT_DOUBLE_EQ(l.position.z, 0.3);
}

TEST(SpreadScene, RectangleLightsHaveEdges) {
    const Scene s = read(
        "[[light]]\nkind = 'rectangle'\nposition_m = [0, 4, 0]\nedge_u_m = [2, 0, 0]\nedge_v_m = [0, 0, "
        "1]\n" +
        ball);
    const Light& l = s.lights.at(0);
    EXPECT_EQ(l.kind, Light::Kind::rectangle);
    EXPECT_EQ(l.edge_u, glm::dvec3(2, 0, 0));
    EXPECT_EQ(l.edge_v, glm::dvec3(0, 0, 1));
}

TEST(SpreadScene, PointsHaveNoExtent) {
    EXPECT_FALSE(
        read("[[light]]\nkind = 'point'\nposition_m = [0, 4, 0]\n" + ball).lights.at(0).has_extent());
}

TEST(SpreadScene, WhatALightLacksOrHasTooMuchIsNamed) {
    EXPECT_NE(error("[[light]]\nkind = 'sphere'\nposition_m = [0, 0, 0]\n" + ball).find("radius_m"),
              std::string::npos);
    EXPECT_NE(error("[[light]]\nkind = 'sphere'\nposition_m = [0, 0, 0]\nradius_m = 0\n" + ball)
                  .find("out of range"),
              std::string::npos);
    EXPECT_NE(error("[[light]]\nkind = 'rectangle'\nposition_m = [0, 0, 0]\nedge_u_m = [1, 0, 0]\n" + ball)
                  .find("edge_v_m"),
              std::string::npos);
    EXPECT_NE(error("[[light]]\nkind = 'rectangle'\nposition_m = [0, 0, 0]\nedge_u_m = [1, 0, 0]\n"
                    "edge_v_m = [2, 0, 0]\n" +
                    ball)
                  .find("span no area"),
              std::string::npos);
    EXPECT_NE(
        error("[[light]]\nkind = 'point'\nposition_m = [0, 0, 0]\nradius_m = 1\n" + ball).find("radius_m"),
        std::string::npos);
}

TEST(SpreadScene, LobesAreReadAndPerfectByDefault) {
    const std::string material = "[[material]]\nname = 'm'\n";
    const Scene plain = read(material + ball);
    EXPECT_EQ(plain.materials.at(0).reflection_exponent, std::numeric_limits<double>::infinity());
    EXPECT_EQ(plain.materials.at(0).transmission_exponent, std::numeric_limits<double>::infinity());
    const Scene s = read(material + "reflection_exponent = 200\ntransmission_exponent = inf\n" + ball);
    EXPECT_EQ(s.materials.at(0).reflection_exponent, 200);
    EXPECT_EQ(s.materials.at(0).transmission_exponent, std::numeric_limits<double>::infinity());
    EXPECT_NE(error(material + "reflection_exponent = -1\n" + ball).find("out of range"), std::string::npos);
    EXPECT_NE(error(material + "transmission_exponent = nan\n" + ball).find("transmission_exponent"),
              std::string::npos);
}

TEST(SpreadScene, SingularTransformsAndUnorderedKeysAreRefused) {
    EXPECT_NE(error("[[object]]\nshape = 'sphere'\nradius_m = 1\n"
                    "matrix = [[1, 0, 0, 0], [2, 0, 0, 0], [0, 0, 1, 0]]\n")
                  .find("flattens or mirrors"),
              std::string::npos);
    EXPECT_NE(error("[[object]]\nshape = 'sphere'\nradius_m = 1\n"
                    "keys = [{ time_s = 1 }, { time_s = 0 }]\n")
                  .find("does not grow"),
              std::string::npos);
    EXPECT_NE(error("[[object]]\nshape = 'sphere'\nradius_m = 1\n"
                    "keys = [{ time_s = 0 }, { time_s = 1, scale = 0 }]\n")
                  .find("'scale' is out of range"),
              std::string::npos);
}

}  // namespace
}  // namespace postlens::test::spread_scene_test
