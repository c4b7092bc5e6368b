// Shares of a command's work, and what `merge` makes of them.
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"

namespace postlens {
namespace {

using nlohmann::json;
using test::CommandTest;
using test::Outcome;
using Words = std::vector<std::string>;

class ShareCommand : public CommandTest {
  protected:
    void SetUp() override {
        CommandTest::SetUp();
        done({"trace", scene_, "-o", frame(), "--size", "96x54", "--for-f-number", "1.4", "--for-focus", "5",
              "--for-shutter", "0:0.02"});
    }
    json done(Words words) {
        words.emplace_back("--json");
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    [[nodiscard]] std::string frame() { return in("frame.exr"); }
    [[nodiscard]] static std::string bytes(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        EXPECT_TRUE(file) << path;
        return {std::istreambuf_iterator<char>(file), {}};
    }
    [[nodiscard]] std::string part(const std::string& name, int i) {
        return in(name + ".part" + std::to_string(i) + ".exr");
    }
    /// Makes a picture whole and in parts, and merges these from the last to the first.
    void is_the_undivided(const std::string& name, const Words& words, int count,
                          const Words& share_by = {}) {
        Words whole = words;
        whole.insert(whole.end(), {"-o", in(name + ".exr")});
        done(whole);
        Words merge{"merge", "-o", in(name + ".merged.exr")};
        for (int i = count - 1; i >= 0; --i) {
            Words one = words;
            one.insert(one.end(), share_by.begin(), share_by.end());
            one.insert(one.end(), {"-o", part(name, i), "--share",
                                   std::to_string(i) + "/" + std::to_string(count), "--threads", "1"});
            done(one);
            merge.push_back(part(name, i));
        }
        done(merge);
        EXPECT_TRUE(bytes(in(name + ".exr")) == bytes(in(name + ".merged.exr"))) << name;
    }
    const std::string scene_ = std::string(POSTLENS_SAMPLES) + "/scenes/bars.toml";
    const Words lens_{"--f-number", "1.4", "--focus", "5"};
};

Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

TEST_F(ShareCommand, MergedPartsAreTheUndividedFileToTheByte) {
    for (const std::string method : {"scatter", "layers", "lightfield"})
        is_the_undivided(method, Words{"focus", frame(), "--method", method} + lens_, 3);
    is_the_undivided("hybrid", Words{"focus", frame(), "--method", "hybrid", "--scene", scene_} + lens_, 2);
    is_the_undivided(
        "exposed",
        Words{"focus", frame(), "--method", "layers", "--exposure", "0.3", "--crop", "5,7,80,40"} + lens_, 5);
    is_the_undivided("motion", {"motionblur", frame(), "--shutter", "0:0.02", "--method", "lightfield"}, 2);
    is_the_undivided("shot", Words{"shoot", frame(), "--shutter", "0:0.02", "--views", "8"} + lens_, 3);
    is_the_undivided("rows", Words{"focus", frame(), "--method", "scatter"} + lens_, 54);
}

TEST_F(ShareCommand, RendersMergeWithTheirHalves) {
    is_the_undivided("rays", Words{"render", scene_, "--size", "48x27", "--spp", "8", "--halves"} + lens_, 4);
    for (const char* half : {"a", "b"}) {
        EXPECT_TRUE(bytes(in(std::string("rays.") + half + ".exr")) ==
                    bytes(in(std::string("rays.merged.") + half + ".exr")));
    }
}

TEST_F(ShareCommand, SamplesOfARenderAddUpToTheUndividedBits) {
    const Words by{"--share-by", "samples"};
    const std::string lit = std::string(POSTLENS_SAMPLES) + "/scenes/still_life.toml";
    is_the_undivided("blocks", Words{"render", scene_, "--size", "32x18", "--spp", "128"} + lens_, 3, by);
    // So many samples that a block has more than one group, and the last block fewer.
    is_the_undivided("groups", Words{"render", scene_, "--size", "8x5", "--spp", "3000"} + lens_, 5, by);
    is_the_undivided("halves",
                     {"render", lit, "--size", "24x15", "--spp", "128", "--halves", "--crop", "3,3,16,9",
                      "--f-number", "1.8", "--focus", "0.8"},
                     4, by);
    for (const char* half : {"a", "b"}) {
        EXPECT_TRUE(bytes(in(std::string("halves.") + half + ".exr")) ==
                    bytes(in(std::string("halves.merged.") + half + ".exr")));
    }
    refused({"merge", part("blocks", 0), part("groups", 1), "-o", in("o.exr")}, ExitCode::invalid_input,
            "one of 5 parts");
    refused({"render", scene_, "--size", "8x5", "--spp", "16", "-o", in("o.exr"), "--share", "0/2",
             "--share-by", "samples"},
            ExitCode::wrong_arguments, "more shares than the samples");
    const json said =
        done({"merge", part("blocks", 2), part("blocks", 0), "-o", in("partial.exr"), "--partial"});
    EXPECT_EQ(said.at("missing"), json({1}));
}

TEST_F(ShareCommand, OtherEndingsAreThoseOfTheUndividedPicture) {
    const Words words = Words{"focus", frame(), "--method", "layers", "--exposure", "0.7"} + lens_;
    is_the_undivided("exposed", words, 2);
    done(words + Words{"-o", in("whole.png")});
    done({"merge", part("exposed", 0), part("exposed", 1), "-o", in("merged.png")});
    EXPECT_TRUE(bytes(in("whole.png")) == bytes(in("merged.png")));
}

TEST_F(ShareCommand, FramesAreDividedByItems) {
    const Words words = Words{"render", scene_, "--size", "16x9", "--spp", "1", "--frames", "0-4"} + lens_;
    done(words + Words{"-o", in("a.%04d.exr"), "--share", "1/2"});
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(std::filesystem::exists(in("a.000" + std::to_string(i) + ".exr")), i % 2 == 1) << i;
    done(words + Words{"-o", in("a.%04d.exr"), "--share", "0/2"});
    done(words + Words{"-o", in("b.%04d.exr")});
    for (int i = 0; i < 5; ++i) {
        const std::string name = ".000" + std::to_string(i) + ".exr";
        EXPECT_TRUE(bytes(in("a" + name)) == bytes(in("b" + name))) << i;
    }
}

TEST_F(ShareCommand, MissingDoubledForeignAndDamagedPartsAreRefusedByName) {
    const Words words = Words{"focus", frame(), "--method", "scatter"} + lens_;
    for (int i = 0; i < 3; ++i) done(words + Words{"-o", part("p", i), "--share", std::to_string(i) + "/3"});
    const auto bad = ExitCode::invalid_input;
    const std::string out = in("out.exr");
    refused({"merge", part("p", 0), part("p", 2), "-o", out}, bad, "1/3");
    refused({"merge", part("p", 0), part("p", 1), part("p", 0), "-o", out}, bad, "0/3 twice");
    refused({"merge", frame(), "-o", out}, bad, "no part");
    refused({"merge", in("none.exr"), "-o", out}, bad, "none.exr");
    // Another number of parts, another setting, another input.
    done(words + Words{"-o", part("q", 0), "--share", "0/2"});
    refused({"merge", part("p", 0), part("q", 0), "-o", out}, bad, "one of 2 parts");
    done({"focus", frame(), "--method", "scatter", "--f-number", "2", "--focus", "5", "-o", part("r", 1),
          "--share", "1/3"});
    refused({"merge", part("p", 0), part("r", 1), "-o", out}, bad,
            R"(--f-number (got ["2"]; expected ["1.4"]))");
    done({"trace", scene_, "-o", in("other.exr"), "--size", "96x54"});
    done(Words{"focus", in("other.exr"), "--method", "scatter", "-o", part("s", 1), "--share", "1/3"} +
         lens_);
    refused({"merge", part("p", 0), part("s", 1), "-o", out}, bad, "FRAME");
    // One changed byte of a pixel.
    std::string changed = bytes(part("p", 1));
    changed[changed.size() - 3] = static_cast<char>(changed[changed.size() - 3] ^ 1);
    std::ofstream(part("p", 1), std::ios::binary) << changed;
    refused({"merge", part("p", 0), part("p", 1), part("p", 2), "-o", out}, bad, "damaged part");
    changed.resize(changed.size() / 2);
    std::ofstream(part("p", 1), std::ios::binary) << changed;
    refused({"merge", part("p", 1), "-o", out}, bad, "p.part1.exr");
    EXPECT_FALSE(std::filesystem::exists(out));
    const json said = done({"merge", part("p", 2), part("p", 0), "-o", out, "--partial"});
    EXPECT_EQ(said.at("missing"), json({1}));
    EXPECT_EQ(said.at("warnings").at(0).at("code"), "partial");
}

TEST_F(ShareCommand, WhatCannotBeDividedSaysSo) {
    const auto two = ExitCode::wrong_arguments;
    const std::string out = in("out.exr");
    for (const std::string share : {"3/3", "-1/3", "1", "1/0", "a/b", "1/3x", "", "0/100001"})
        refused(Words{"focus", frame(), "-o", out, "--share", share} + lens_, two, "--share");
    refused(Words{"focus", frame(), "-o", out, "--share", "0/55"} + lens_, two, "more shares than rows");
    refused(Words{"focus", frame(), "-o", in("out.png"), "--share", "0/2"} + lens_, two, "out.png");
    refused(Words{"focus", frame(), "-o", out, "--share", "0/2", "--target-db", "40"} + lens_, two,
            "--share");
    refused({"trace", scene_, "-o", out, "--share", "0/2"}, two, "--share");
}

}  // namespace
}  // namespace postlens
