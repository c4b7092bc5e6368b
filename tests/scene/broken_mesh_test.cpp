// Broken glTF, PLY and OBJ files are refused in one line, within time and memory.
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "scene/scene.h"
#include "tests/scene/gltf_text.h"
#include "tests/scene/mesh_text.h"
#include "tests/scene/read_apart.h"

namespace postlens::test::broken_mesh_test {
namespace {

using testing::HasSubstr;

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
    const ReadOutcome walked = read_apart(write("chain.gltf", chain.text()));
    EXPECT_TRUE(walked.loaded) << walked.text;
    // Every node has the same child twice, which would be 2^40 visits.
    GltfText doubled;
    doubled.nodes.clear();
    for (int i = 0; i < 40; ++i) doubled.nodes += fmt::format(R"({{"children":[{0},{0}]}},)", i + 1);
    doubled.nodes += R"({"mesh":0})";
    EXPECT_THAT(error(doubled), HasSubstr("expected one node above each"));
    const std::string nested(300'000, '[');
    const ReadOutcome nest =
        read_apart(write("nest.gltf", R"({"asset":{"version":"2.0"},"extras":)" + nested));
    EXPECT_TRUE(nest.refused) << nest.text;
    std::string wide = R"({"asset":{"version":"2.0"},"extras":[)";
    for (int i = 0; i < 5'000'000; ++i) wide += "[],";
    const ReadOutcome flood = read_apart(write("wide.gltf", wide));
    EXPECT_TRUE(flood.refused) << flood.text;
    EXPECT_THAT(flood.text, HasSubstr("too many values"));
    // An accessor without a buffer, whose elements are zero.
    GltfText zeros;
    std::string text = zeros.text();
    const auto at = text.find(R"("bufferView":0,)");
    text.erase(at, 15);
    text.replace(text.find(R"("count":3)"), 9, R"("count":3000000000)");
    const ReadOutcome empty = read_apart(write("zeros.gltf", text));
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
        const ReadOutcome o = read_apart(write(name + ".ply", text));
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
        const ReadOutcome o = read_apart(write(name + ".obj", text));
        EXPECT_TRUE(o.refused) << name << ": " << o.text;
    }
}

}  // namespace
}  // namespace postlens::test::broken_mesh_test
