// PATHS.toml: the example, all kinds of motion, and all kinds of errors with their lines.
#include "motionblur/paths/paths_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::paths_file_test {
namespace {

namespace fs = std::filesystem;
using glm::dvec2;

class PathsFile : public testing::Test {
  protected:
    fs::path file(const std::string& text) {
        const fs::path path = folder_.path() / "paths.toml";
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    // Checks that the error is one line that begins with the path and contains `part`.
    void refused(const fs::path& path, const std::string& part) {
        expect_refused([&] { (void)read_paths(path); }, ExitCode::invalid_input, part, path.string());
    }
    void refused_text(const std::string& text, const std::string& part) { refused(file(text), part); }
    TemporaryFolder folder_;
};

TEST_F(PathsFile, TheExampleIsRead) {
    const fs::path path = fs::path(POSTLENS_SAMPLES) / "paths" / "example.toml";
    const auto paths = read_paths(path);
    ASSERT_EQ(paths.size(), 4U);
    EXPECT_EQ(paths[0].ids, (std::vector<std::uint32_t>{3, 4}));
    EXPECT_TRUE(paths[0].objects.empty());
    EXPECT_EQ(paths[0].source, path.string() + ":4");
    const auto& parabola = std::get<ScreenPath>(paths[0].motion);
    EXPECT_EQ(parabola.kind(), PathKind::catmull_rom);
    EXPECT_EQ(parabola.at(0.5), dvec2(60, -40));
    const auto& bezier = std::get<ScreenPath>(paths[1].motion);
    EXPECT_EQ(bezier.kind(), PathKind::bezier);
    // At u = 1/2 the ends have weight 1/8 and the handles' ends 3/8.
    EXPECT_NEAR(bezier.at(0.5).x, (3 * 2 + 3 * 30 + 90) / 8.0, 1e-13);
    EXPECT_NEAR(bezier.at(0.5).y, (3 * 10 + 30) / 8.0, 1e-13);
    EXPECT_EQ(std::get<ScreenPath>(paths[2].motion).kind(), PathKind::polyline);
    EXPECT_EQ(std::get<ScreenPath>(paths[2].motion).at(0.3), dvec2(30, 0));
    EXPECT_EQ(paths[3].objects, std::vector<std::string>{"wheel"});
    const auto& keys = std::get<RigidKeys>(paths[3].motion);
    ASSERT_EQ(keys.size(), 2U);
    EXPECT_EQ(keys[0], TransformKey{});
    EXPECT_EQ(keys[1].time_s, 1);
    EXPECT_EQ(keys[1].translation, glm::dvec3(0.4, 0, 0));
    EXPECT_NEAR(keys[1].rotation.w, std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(keys[1].rotation.z, -std::sqrt(0.5), 1e-15);
}

const std::string knots = "knots = [{time_s=0, at_px=[0,0]}]\n";

TEST_F(PathsFile, ErrorsNameTheLine) {
    refused_text("[[path]]\nids=[1]\nspeed=3\n" + knots,
                 ":3:1: path 1: unknown key (got 'speed'; nearest known key:");
    refused_text("[[paths]]\nids=[1]\n",
                 ":1:3: paths file: unknown key (got 'paths'; nearest known key: 'path')");
    refused_text("\n\n[[path]]\n" + knots, ":3:1: path 1: moves nothing (expected 'ids' or 'objects'");
    refused_text("[[path]]\nids=[]\n" + knots, "moves nothing");
    refused_text("[[path]]\nids=[1]\n", ":1:1: path 1: has no motion (expected 'knots' or 'keys')");
    refused_text("[[path]]\nids=[1]\n" + knots + "keys=[{time_s=0}]\n",
                 ":4:6: path 1: 'knots' and 'keys' cannot stand");
    refused_text("[[path]]\nids=[1]\nkeys=[{time_s=0}]\nkind='bezier'\n",
                 "'keys' and 'kind' cannot stand together");
    refused_text("[[path]]\nids=[1]\nknots=[]\n", ":3:7: path 1: 'knots' is empty");
    refused_text("[[path]]\nids=[1]\nkeys=[]\n", ":3:6: path 1: 'keys' is empty");
    refused_text("[[path]]\nids=[1]\nkind='spline'\n" + knots,
                 ":3:6: path 1: 'kind' is unknown (got 'spline'; nearest known: 'polyline'");
    refused_text("", ":1: no paths");
    refused_text("path = 3\n", ":1:8: paths file: 'path' is a number");
    refused_text("[[path]\n", "not valid TOML");
}

TEST_F(PathsFile, IdsAreWholeAndOnce) {
    const auto ids = [&](const std::string& value) { return "[[path]]\nids=" + value + "\n" + knots; };
    refused_text(ids("[1.5]"), ":2:5: path 1: 'ids' is not whole (got 1.5");
    refused_text(ids("[0]"), ":2:6: path 1: 'ids' is out of range (got 0; expected 1 to 4.29497e+09)");
    refused_text(ids("[-1]"), "'ids' is out of range");
    refused_text(ids("[4294967296]"), "'ids' is out of range");
    refused_text(ids("[nan]"), "'ids' is out of range");
    refused_text(ids("['a']"), "'ids' is a text");
    refused_text(ids("7"), "'ids' is a number (got 7; expected an array of numbers)");
    refused_text(ids("[2, 2]"), "id 2 is moved twice");
    refused_text(ids("[2]") + ids("[1, 2]"), ":5:5: path 2: id 2 is moved twice");
    refused_text("[[path]]\nobjects=['a','a']\n" + knots, ":2:9: path 1: object 'a' is moved twice");
    refused_text("[[path]]\nobjects=['']\n" + knots, "'objects' is not a usable text");
    EXPECT_EQ(read_paths(file(ids("[4294967295]")))[0].ids[0], 4294967295U);
}

TEST_F(PathsFile, KnotsAreFiniteAndInOrder) {
    const auto with = [&](const std::string& value, const std::string& kind = "polyline") {
        return "[[path]]\nids=[1]\nkind='" + kind + "'\nknots=[\n" + value + "]\n";
    };
    refused_text(with("{time_s=0,at_px=[0,0]},\n{time_s=0,at_px=[1,0]}"),
                 ":6:9: path 1: knot 2: 'time_s' does not grow (got 0 s after 0 s)");
    refused_text(with("{time_s=1,at_px=[0,0]},\n{time_s=0.5,at_px=[1,0]}"), "does not grow");
    refused_text(with("{time_s=nan,at_px=[0,0]}"), "'time_s' is out of range (got nan");
    refused_text(with("{time_s=inf,at_px=[0,0]}"), "'time_s' is out of range");
    refused_text(with("{time_s=0,at_px=[0,nan]}"), ":5:20: path 1: knot 1: 'at_px' is out of range (got nan");
    refused_text(with("{time_s=0,at_px=[1e13,0]}"), "'at_px' is out of range");
    refused_text(with("{time_s=0,at_px=[1,2,3]}"), "'at_px' has the wrong length (got 3");
    refused_text(with("{time_s=0,at_px=7}"), "'at_px' is a number");
    refused_text(with("{time_s=0}"), "has no 'at_px'");
    refused_text(with("{at_px=[0,0]}"), "has no 'time_s'");
    refused_text(with("{time_s=0,at_px=[0,0],z=1}"), "unknown key (got 'z'");
    refused_text(with("{time_s=0,at_px=[0,0],out_px=[1,1]}"),
                 R"('out_px' is for kind = "bezier" (got "polyline"))");
    refused_text(with("{time_s=0,at_px=[0,0],in_px=[1,1]}", "catmull-rom"),
                 R"('in_px' is for kind = "bezier")");
    refused_text(with("{time_s=0,at_px=[0,0],in_px=[1,inf]}", "bezier"), "'in_px' is out of range");
    refused_text(with("3"), "'knots' holds a number");
    std::string many;
    for (int i = 0; i <= 100'000; ++i) many += "{time_s=" + std::to_string(i) + ",at_px=[0,0]},\n";
    refused_text(with(many), ":4:7: path 1: 'knots' has too many (got 100001; expected at most 100000)");
}

TEST_F(PathsFile, KeysFollowTheRulesOfScenes) {
    const auto with = [&](const std::string& value) { return "[[path]]\nids=[1]\nkeys=[\n" + value + "]\n"; };
    refused_text(with("{time_s=0},{time_s=0}"), "'time_s' does not grow");
    refused_text(with("{translate_m=[0,0,0]}"), "has no 'time_s'");
    refused_text(with("{time_s=0,translate_m=[nan,0,0]}"), "'translate_m' is out of range");
    refused_text(with("{time_s=0,rotate_degrees=3}"), "one angle needs 'rotate_axis'");
    refused_text(with("{time_s=0,at_px=[0,0]}"), "unknown key (got 'at_px'");
    refused_text(with("{time_s=0},\n{time_s=1,rotate_degrees=[0,0,200]}"),
                 ":5:1: path 1: key 2: the turn since the key before is ambiguous");
    const auto keys = std::get<RigidKeys>(
        read_paths(file(with("{time_s=-1,quaternion=[2,0,0,0]},{time_s=2,scale=3}")))[0].motion);
    EXPECT_EQ(keys[0].rotation, glm::dquat(1, 0, 0, 0));
    EXPECT_EQ(keys[1].scale, glm::dvec3(3));
}

TEST_F(PathsFile, WhatIsNoFileIsRefused) {
    refused(folder_.path() / "missing.toml", "cannot read (no such file)");
    refused(folder_.path(), "cannot read (got a folder");
    // A sparse file of 256 MB and one byte.
    const fs::path large = folder_.path() / "large.toml";
    std::ofstream(large).close();
    fs::resize_file(large, 256'000'001);
    refused(large, "too large (got 256000001 bytes; expected at most 256000000)");
    if (::geteuid() != 0) {  // root may read everything
        const fs::path locked = file(knots);
        ::chmod(locked.c_str(), 0);
        refused(locked, "cannot read");
    }
}

TEST_F(PathsFile, NamesBecomeIds) {
    const auto paths = read_paths(
        file("[[path]]\nids=[5]\nobjects=['wheel']\n" + knots + "[[path]]\nobjects=['post']\n" + knots));
    const std::map<std::uint32_t, std::string> names{
        {1, "wheel"}, {2, "post"}, {4, "wheel"}, {5, "bar"}, {6, ""}};
    EXPECT_EQ(resolve_ids(paths, names), (std::vector<std::vector<std::uint32_t>>{{5, 1, 4}, {2}}));
    const auto unresolved = [&](const std::map<std::uint32_t, std::string>& other, const std::string& text) {
        try {
            (void)resolve_ids(paths, other);
            ADD_FAILURE() << "expected: " << text;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            EXPECT_EQ(std::string(e.what()), (folder_.path() / "paths.toml").string() + text);
        }
    };
    unresolved({{1, "wheel"}}, ":1: the sample file has no such id (got 5; expected one of 1 from 1 to 1)");
    unresolved({}, ":1: the sample file has no such id (got 5; expected none)");
    unresolved({{5, "bar"}, {2, "wheels"}},
               ":1: the sample file has no such object (got 'wheel'; nearest name: 'wheels')");
    unresolved({{5, "wheel"}}, ":1: id 5 ('wheel') is moved twice (the other time at " +
                                   (folder_.path() / "paths.toml").string() + ":1)");
}

}  // namespace
}  // namespace postlens::test::paths_file_test
