// PLY files: any order of elements and properties, strips, comments, binary data.
#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "pictures/srgb.h"
#include "scene/scene.h"
#include "tests/support/command_test.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::ply_scene_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path lists = fs::path(POSTLENS_TEST_DATA) / "mesh" / "ply-lists";

class PlyLists : public CommandTest {};

TEST_F(PlyLists, EveryOrderOfElementsAndPropertiesGivesThePictureOfThePlainFile) {
    const auto image = [&](const fs::path& file, const std::string& name) {
        EXPECT_EQ(run({"trace", file.string(), "-o", in("a.exr"), "--size", "96x64"}).exit_code, 0) << file;
        EXPECT_EQ(run({"image", in("a.exr"), "-o", in(name)}).exit_code, 0) << file;
        return bytes_of(in(name));
    };
    const std::string wanted = image(lists / "plain.ply", "plain.exr");
    ASSERT_GT(wanted.size(), 96U * 64U);
    int count = 0;
    for (const auto& file : fs::directory_iterator(lists)) {
        const auto info = nlohmann::json::parse(run({"info", "--json", file.path().string()}).out);
        EXPECT_EQ(info["triangles"], 3) << file.path();
        EXPECT_TRUE(image(file.path(), "other.exr") == wanted) << file.path();
        ++count;
    }
    EXPECT_EQ(count, 20);
}

class PlyText : public testing::Test {
  protected:
    Scene read(const std::string& bytes) {
        const fs::path path = folder_.path() / "t.ply";
        std::ofstream(path, std::ios::binary) << bytes;
        return read_scene(path);
    }
    const Mesh& mesh(const std::string& bytes) {
        scene_ = read(bytes);
        EXPECT_EQ(scene_.objects.size(), 1U);
        return *std::get<std::shared_ptr<const Mesh>>(scene_.objects.at(0).shape);
    }
    std::string error(const std::string& bytes) {
        try {
            std::ignore = read(bytes);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            return e.what();
        }
        return "no error";
    }
    [[nodiscard]] bool has_note(const std::string& text) const {
        for (const std::string& note : scene_.notes) {
            if (note.find(text) != std::string::npos) return true;
        }
        return false;
    }

    TemporaryFolder folder_;
    Scene scene_;
};

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string face_list = "property list uchar int vertex_indices\n";

template <typename T>
void put(std::string& to, T value, bool is_big) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (is_big == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
    to.append(bytes.data(), bytes.size());
}

TEST_F(PlyText, StripsTurnEverySecondTriangleAndStartAgainAfterMinusOne) {
    const Mesh& m = mesh(
        "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\n"
        "element vertex 5\n" +
        xyz + "end_header\n10 0 1 2 3 -1 4 4 1 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 1\n");
    // 4 4 1 and 4 1 2 belong to one strip: the first has no area, and the second has the opposite winding.
    const std::vector<glm::uvec3> wanted{{0, 1, 2}, {2, 1, 3}, {1, 4, 2}, {1, 2, 0}};
    EXPECT_EQ(m.triangles, wanted);
}

TEST_F(PlyText, CommentsMayStandAnywhere) {
    const Mesh& m =
        mesh("ply\ncomment before the format\nformat ascii 1.0\nelement vertex 3\nobj_info 1 2\n" + xyz +
             "comment within\nelement face 1\n" + face_list +
             "end_header\ncomment 1 2 3\n0 0 0\n1 0 0\ncomment between vertices\n0 1 0\n"
             "  comment before the face\n3 0 1 2\n");
    EXPECT_EQ(m.positions.at(2), glm::vec3(0, 1, 0));
    EXPECT_EQ(m.triangles.size(), 1U);
}

// The first byte of the first float is 0x0a. After a CR it must not be taken as part of the line end.
TEST_F(PlyText, TheFirstByteOfDataMayBeALineFeedOrACarriageReturn) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        for (const bool is_big : {false, true}) {
            for (const std::uint32_t first : {0x0A0A0A0AU, 0x0D0A0D0AU, 0x0A0D0A0DU}) {
                std::string text = "ply\nformat binary_" + std::string(is_big ? "big" : "little") +
                                   "_endian 1.0\nelement vertex 3\n" + xyz + "element face 1\n" + face_list +
                                   "end_header\n";
                for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
                    text.replace(at, 1, end);
                put(text, first, is_big);
                for (const float v : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) put(text, v, is_big);
                text += '\3';
                for (const int i : {0, 1, 2}) put(text, i, is_big);
                const Mesh& m = mesh(text);
                EXPECT_EQ(m.positions.at(0).x, std::bit_cast<float>(first));
                EXPECT_EQ(m.positions.at(2), glm::vec3(0, 1, 0));
            }
        }
    }
}

TEST_F(PlyText, CountsOfListsAreOfAnyType) {
    for (const std::string type : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"}) {
        const Mesh& m = mesh(
            "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\n" + xyz + "element face 1\r\nproperty list " +
            type + " uint vertex_index\r\nend_header\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n4 0 1 2 3\r\n");
        EXPECT_EQ(m.triangles.size(), 2U) << type;
    }
}

TEST_F(PlyText, CornersCarryNormalsColoursAndTextureCoordinatesInAnyOrder) {
    const Mesh& m = mesh(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty uchar blue\nproperty ushort green\n"
        "property float red\nproperty float nz\nproperty float ny\nproperty float nx\n"
        "property float t\nproperty float s\n" +
        xyz + "element face 1\n" + face_list +
        "end_header\n51 65535 0.5 2 0 0 .25 .75 0 0 0\n0 0 nan 0 3 0 0 1 1 0 0\n"
        "255 0 7 0 0 4 1 0 0 1 0\n3 0 1 2\n");
    ASSERT_EQ(m.colours.size(), 3U);
    EXPECT_EQ(m.colours[0], glm::vec3(linear_from_srgb(0.5F), 1, linear_from_srgb(0.2F)));
    EXPECT_EQ(m.colours[1], glm::vec3(0));
    EXPECT_EQ(m.colours[2], glm::vec3(1, 0, 1));
    EXPECT_EQ(m.normals.at(0), glm::vec3(0, 0, 1));
    EXPECT_EQ(m.normals.at(1), glm::vec3(0, 1, 0));
    EXPECT_EQ(m.uvs.at(0), glm::vec2(0.75F, 0.25F));
}

TEST_F(PlyText, TextureCoordinatesOfFacesBelongToTheirCornersAlone) {
    const Mesh& m = mesh("ply\nformat ascii 1.0\nelement vertex 4\n" + xyz + "element face 3\n" + face_list +
                         "property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
                         "3 0 1 2 0\n3 0 1 2 6 0 0 1 0 0 1\n3 1 3 2 6 .5 .5 .6 .5 .7 .5\n");
    ASSERT_EQ(m.triangles.size(), 3U);
    const auto corner = [&](std::size_t t, int k) { return m.triangles[t][k]; };
    EXPECT_EQ(m.uvs.at(corner(0, 1)), glm::vec2(0));
    EXPECT_EQ(m.uvs.at(corner(1, 1)), glm::vec2(1, 0));
    EXPECT_EQ(m.uvs.at(corner(2, 0)), glm::vec2(0.5F));
    EXPECT_EQ(m.positions.at(corner(2, 0)), glm::vec3(1, 0, 0));
}

TEST_F(PlyText, WhatIsLeftOutIsSaid) {
    std::ignore = mesh("ply\nformat ascii 1.0\nelement vertex 3\n" + xyz +
                       "element face 2\nproperty uchar red\n" + face_list +
                       "element edge 1\nproperty int a\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
                       "9 3 0 1 2\n9 2 0 1\n4\n");
    EXPECT_TRUE(has_note("the element 'edge' is left out"));
    EXPECT_TRUE(has_note("colours of faces are left out"));
    EXPECT_TRUE(has_note("points and lines are left out"));
}

TEST_F(PlyText, ErrorsNameTheirCause) {
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz;
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_THAT(error(head + "end_header\n" + points), HasSubstr("has no faces (got 3 points"));
    EXPECT_THAT(
        error(head + "element face 1\nproperty list uchar int ids\nend_header\n" + points + "3 0 1 2\n"),
        HasSubstr("its element 'face' has no list vertex_indices"));
    EXPECT_THAT(error(head + "element face 1\n" + face_list + "end_header\n" + points + "3 0 1 7\n"),
                HasSubstr("a face refers to no vertex (got 7; expected less than 3)"));
    EXPECT_THAT(error(head + "element face 1\n" + face_list + "end_header\n" + points + "3 0 1 -1\n"),
                HasSubstr("a face refers to no vertex (got -1"));
    EXPECT_THAT(error(head + "element face 1\n" + face_list + "end_header\n" + points + "-3 0 1 2\n"),
                HasSubstr("whose count is no whole number (got -3)"));
    EXPECT_THAT(error(head + "element face 2\n" + face_list + "end_header\n" + points + "3 0 1 2\n"),
                HasSubstr("ends in its element 'face' (expected 2 of them)"));
    EXPECT_THAT(
        error(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n"),
        HasSubstr("lacks a coordinate (expected properties x, y and z)"));
    EXPECT_THAT(error("ply\nformat ascii 1.0\nelement face 1\n" + face_list + "end_header\n3 0 1 2\n"),
                HasSubstr("has no element 'vertex'"));
    EXPECT_THAT(error("plywood\nformat ascii 1.0\n"), HasSubstr("is no PLY file"));
}

}  // namespace
}  // namespace postlens::test::ply_scene_test
