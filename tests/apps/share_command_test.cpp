// Shares of a command's work, and what `merge` makes of them.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"

namespace postlens::test::share_command_test {
namespace {

using nlohmann::json;

class ShareCommand : public CommandTest {
  protected:
    json done(Words words) {
        words.emplace_back("--json");
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    /// A sample file, traced at the first call.
    [[nodiscard]] std::string frame() {
        std::string path = in("frame.exr");
        if (!std::filesystem::exists(path)) {
            done({"trace", scene_, "-o", path, "--size", "96x54", "--for-f-number", "1.4", "--for-focus", "5",
                  "--for-shutter", "0:0.02"});
        }
        return path;
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
        EXPECT_TRUE(bytes_of(in(name + ".exr")) == bytes_of(in(name + ".merged.exr"))) << name;
    }
    const std::string scene_ = POSTLENS_SAMPLES "/scenes/bars.toml";
    const Words lens_{"--f-number", "1.4", "--focus", "5"};
};

TEST_F(ShareCommand, APartIsNotTheWhole) {
    const auto warnings_of = [&](const Words& words) {
        std::vector<std::string> codes;
        const json said = done(words);
        for (const json& warning : said.at("warnings")) codes.push_back(warning.at("code"));
        return codes;
    };
    const auto warns = [&](const Words& words) {
        const std::vector<std::string> codes = warnings_of(words);
        return std::find(codes.begin(), codes.end(), "part") != codes.end();
    };
    const Words trace{"trace", scene_, "--size", "32x18", "--share"};
    done(trace + Words{"1/3", "-o", part("t", 1)});
    done(trace + Words{"0/1", "-o", in("all.exr")});
    EXPECT_TRUE(warns({"info", part("t", 1)}));
    EXPECT_TRUE(warns({"image", part("t", 1), "-o", in("x.exr")}));
    EXPECT_TRUE(warns(Words{"focus", part("t", 1), "-o", in("x.exr")} + lens_));
    EXPECT_TRUE(warns(
        Words{"compare", in("x.exr"), in("x.exr"), "--map-causes", in("why.png"), "--frame", part("t", 1)} +
        lens_));
    // Nor is a part of a picture a picture.
    for (const Words& by : {Words{}, Words{"--share-by", "samples"}}) {
        const Words render = Words{"render", scene_, "--size", "16x9", "--spp", "64"} + lens_ + by;
        done(render + Words{"--share", "1/2", "-o", part("r", 1)});
        EXPECT_TRUE(warns({"info", part("r", 1)}));
        EXPECT_TRUE(warns({"image", part("r", 1), "-o", in("x.exr")}));
        EXPECT_TRUE(warns(Words{"focus", part("r", 1), "-o", in("x.exr")} + lens_));
        EXPECT_TRUE(warns({"compare", part("r", 1), part("r", 1)}));
    }
    EXPECT_TRUE(
        warns({"motionblur", part("r", 1), "-o", in("x.exr"), "--shutter", "0:1", "--vectors", "R,G"}));
    EXPECT_FALSE(warns({"info", frame()}));
    EXPECT_FALSE(warns({"info", in("all.exr")}));
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
    // As many shares as rows.
    is_the_undivided("rows", Words{"focus", frame(), "--method", "scatter", "--crop", "0,40,96,12"} + lens_,
                     12);
}

TEST_F(ShareCommand, RendersMergeWithTheirHalves) {
    is_the_undivided("rays", Words{"render", scene_, "--size", "48x27", "--spp", "8", "--halves"} + lens_, 4);
    for (const char* half : {"a", "b"}) {
        EXPECT_TRUE(bytes_of(in(std::string("rays.") + half + ".exr")) ==
                    bytes_of(in(std::string("rays.merged.") + half + ".exr")));
    }
}

TEST_F(ShareCommand, SamplesOfARenderAddUpToTheUndividedBits) {
    const Words by{"--share-by", "samples"};
    const std::string lit = POSTLENS_SAMPLES "/scenes/still_life.toml";
    is_the_undivided("blocks", Words{"render", scene_, "--size", "32x18", "--spp", "128"} + lens_, 3, by);
    // So many samples that a block has more than one group, and the last block fewer.
    is_the_undivided("groups", Words{"render", scene_, "--size", "8x5", "--spp", "3000"} + lens_, 5, by);
    is_the_undivided("halves",
                     {"render", lit, "--size", "24x15", "--spp", "128", "--halves", "--crop", "3,3,16,9",
                      "--f-number", "1.8", "--focus", "0.8"},
                     4, by);
    for (const char* half : {"a", "b"}) {
        EXPECT_TRUE(bytes_of(in(std::string("halves.") + half + ".exr")) ==
                    bytes_of(in(std::string("halves.merged.") + half + ".exr")));
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
    EXPECT_TRUE(bytes_of(in("whole.png")) == bytes_of(in("merged.png")));
}

TEST_F(ShareCommand, TracesMergeToTheUndividedFile) {
    const Words lens{"--for-f-number", "1.4", "--for-focus", "5"};
    const std::string samples = POSTLENS_SAMPLES;
    is_the_undivided("pinhole", {"trace", scene_, "--size", "64x37", "--subdivide", "3"}, 3);
    is_the_undivided("lens", Words{"trace", scene_, "--size", "48x27", "--overscan", "auto"} + lens, 5);
    is_the_undivided("each", Words{"trace", scene_, "--size", "16x9"} + lens, 10);
    is_the_undivided("glass",
                     {"trace", samples + "/scenes/still_life.toml", "--size", "48x32", "--for-f-number",
                      "1.8", "--for-focus", "0.8", "--compression", "none"},
                     4);
    // More rows than are in memory at once, so that shares begin at other rows than the bands of the trace.
    is_the_undivided("bands",
                     {"trace", samples + "/scenes/still_life.toml", "--size", "24x48", "--for-f-number",
                      "1.8", "--for-focus", "0.8", "--overscan", "5"},
                     3);
    // The rows differ in detail, and the plan is that of the whole image.
    is_the_undivided("planned",
                     Words{"trace", scene_, "--size", "50x33", "--plan", "--target-db", "40"} + lens, 3);
    is_the_undivided("keys",
                     {"trace", samples + "/scenes/motion.toml", "--size", "48x27", "--for-shutter", "0:0.04",
                      "--keys", "3", "--exposure", "1"},
                     3);
    // Samples of a batch share the rays of the means over rough surfaces, and a share has other batches.
    const json rough = done({"trace", samples + "/scenes/blender_still.glb", "-o", in("rough.exr"), "--size",
                             "16x9", "--share", "0/2"});
    EXPECT_EQ(rough.at("warnings").at(0).at("code"), "share");
    // A part opens like any sample file; what it lacks shows nothing.
    EXPECT_EQ(done({"info", part("lens", 2)}).at("width"), 48);
    const auto bad = ExitCode::invalid_input;
    const std::string out = in("out.exr");
    refused({"merge", part("lens", 0), part("lens", 2), "-o", out}, bad, "1/5, 3/5, 4/5");
    refused({"merge", part("lens", 0), part("keys", 1), "-o", out}, bad, "one of 3 parts");
    refused({"merge", in("lens.exr"), "-o", out}, bad, "no part");
    refused({"merge", part("lens", 0), part("lens", 0), "-o", out}, bad, "0/5 twice");
    refused({"merge", part("lens", 0), "-o", in("out.png")}, ExitCode::wrong_arguments, "out.png");
    const json said = done({"merge", part("lens", 3), part("lens", 1), "-o", out, "--partial"});
    EXPECT_EQ(said.at("missing"), json({0, 2, 4}));
    done({"focus", out, "-o", in("focused.exr"), "--f-number", "1.4", "--focus", "5"});
}

TEST_F(ShareCommand, ItemsOfASweepMergeInTheirFolder) {
    const Words sweep{"sweep", frame(), "--f-number", "1.4,2,2.8,4", "--focus", "5", "--method", "scatter"};
    done(sweep + Words{"-o", in("whole")});
    for (const std::string share : {"2/3", "0/3"}) done(sweep + Words{"-o", in("parts"), "--share", share});
    const auto table = [&](int i) { return in("parts/sweep." + std::to_string(i) + "-of-3.json"); };
    const auto bad = ExitCode::invalid_input;
    refused({"merge", table(0), table(2), "-o", in("parts")}, bad, "1/3");
    refused({"merge", table(0), "-o", in("elsewhere")}, ExitCode::wrong_arguments, "not the folder");
    json said = done({"merge", table(0), table(2), "-o", in("parts"), "--partial"});
    EXPECT_EQ(said.at("missing"), json({1}));
    EXPECT_EQ(said.at("pictures").size(), 3U);
    done(sweep + Words{"-o", in("parts"), "--share", "1/3"});
    said = done({"merge", table(1), table(2), table(0), "-o", in("parts") + "/"});
    EXPECT_EQ(said.at("made"), 0);
    EXPECT_EQ(said.at("pictures").size(), 4U);
    for (const auto& entry : std::filesystem::directory_iterator(in("whole"))) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(".exr") || name.ends_with(".png")) {
            EXPECT_TRUE(bytes_of(in("whole/" + name)) == bytes_of(in("parts/" + name))) << name;
        }
    }
    EXPECT_TRUE(std::filesystem::exists(in("parts/sweep.csv")));
    // Tables of other sweeps in the folder do not count.
    const Words named{"sweep",   frame(),    "--focus", "5",  "--method",
                      "scatter", "--frames", "p.%02d",  "-o", in("twice")};
    done(named + Words{"--f-number", "2,4"});
    for (const std::string share : {"0/3", "1/3", "2/3"})
        done(named + Words{"--f-number", "8,11,16", "--share", share});
    for (const std::string share : {"0/2", "1/2"})
        done(named + Words{"--f-number", "1.4,2.8", "--share", share});
    said = done({"merge", in("twice/sweep.0-of-2.json"), in("twice/sweep.1-of-2.json"), "-o", in("twice")});
    EXPECT_EQ(said.at("kept"), 2);
    // The names of pictures are a setting.
    done(sweep + Words{"-o", in("named"), "--share", "0/2", "--frames", "a.%d"});
    done(sweep + Words{"-o", in("named"), "--share", "1/2", "--frames", "b.%d"});
    refused({"merge", in("named/sweep.0-of-2.json"), in("named/sweep.1-of-2.json"), "-o", in("named")}, bad,
            "--frames (got [\"b.%d\"]; expected [\"a.%d\"])");
    said = done({"merge", table(1), table(2), table(0), "-o", in("parts")});
    EXPECT_TRUE(said.at("warnings").empty());
    const std::string gone = said.at("pictures")[0].at("file");
    std::filesystem::remove(in("parts/" + gone));
    const Words joined{"merge", table(1), table(2), table(0), "-o", in("parts")};
    refused(joined, bad, "1 of 4 pictures are missing");
    said = done(joined + Words{"--partial"});
    EXPECT_EQ(said.at("pictures").size(), 3U);
    ASSERT_EQ(said.at("warnings").size(), 1U);
    EXPECT_EQ(said.at("warnings")[0].at("code"), "partial");
    EXPECT_NE(said.at("warnings")[0].at("text").get<std::string>().find(gone), std::string::npos);
    std::ofstream(in("parts/sweep.9-of-9.json")) << "{}";
    refused({"merge", in("parts/sweep.9-of-9.json"), "-o", in("parts")}, bad, "no part");
    std::ofstream(in("parts/sweep.9-of-9.json"))
        << R"({"part": {"share": [0, 1], "crop": null, "made_by": {}, "arguments": ["render", "x"]}})";
    refused({"merge", in("parts/sweep.9-of-9.json"), "-o", in("parts")}, bad, "damaged part");
}

TEST_F(ShareCommand, SharesOfASweepMayHaveNamesOfAnyBytes) {
    const std::string odd = in("50%25 \xE9.exr");  // \xE9 alone is not UTF-8
    std::filesystem::copy_file(frame(), odd);
    const Words sweep{"sweep",    odd,       "--f-number", "4,8",           "--focus", "5",
                      "--method", "scatter", "--frames",   "p\xE9%02d.png", "-o",      in("s")};
    for (const std::string share : {"0/2", "1/2"}) done(sweep + Words{"--share", share});
    const json said = done({"merge", in("s/sweep.0-of-2.json"), in("s/sweep.1-of-2.json"), "-o", in("s")});
    EXPECT_EQ(said.at("kept"), 2);
    EXPECT_TRUE(said.at("warnings").empty());
    // The table of the whole sweep is read as well.
    EXPECT_EQ(done(sweep + Words{"--resume"}).at("kept"), 2);
}

TEST_F(ShareCommand, PointsOfAChartMergeInTheirFolder) {
    const Words chart{"chart",    scene_, "--size",   "48x27", "--rays",          "1,4", "--views",   "4",
                      "--depths", "4",    "--rounds", "1",     "--reference-spp", "16",  "--no-plots"};
    const json whole = done(chart + Words{"-o", in("whole")});
    const Words parts{in("c/chart.0-of-3.json"), in("c/chart.1-of-3.json"), in("c/chart.2-of-3.json")};
    done(chart + Words{"-o", in("c"), "--share", "1/3"});
    EXPECT_FALSE(std::filesystem::exists(in("c/index.html")));
    done(chart + Words{"-o", in("c"), "--share", "0/3"});
    refused(Words{"merge", "-o", in("c"), parts[0], parts[1]}, ExitCode::invalid_input, "2/3");
    done(chart + Words{"-o", in("c"), "--share", "2/3", "--restart"});
    const json merged = done(Words{"merge", "-o", in("c")} + parts);
    ASSERT_EQ(merged.at("points").size(), whole.at("points").size());
    for (std::size_t i = 0; i < whole.at("points").size(); ++i) {
        const json &a = whole.at("points")[i], &b = merged.at("points")[i];
        EXPECT_EQ(a.at("name"), b.at("name"));
        EXPECT_EQ(a.at("figures"), b.at("figures")) << a.at("name");
        EXPECT_EQ(b.at("seconds").size(), 1U) << a.at("name");
    }
    EXPECT_EQ(merged.at("noise_rms"), whole.at("noise_rms"));
    EXPECT_TRUE(std::filesystem::exists(in("c/index.html")));
    // A share keeps to its own request, too.
    Words other = chart;
    std::replace(other.begin(), other.end(), std::string("48x27"), std::string("32x18"));
    refused(other + Words{"-o", in("c"), "--share", "0/3"}, ExitCode::wrong_arguments, "holds another chart");
    refused(chart + Words{"-o", in("d"), "--share", "0/99"}, ExitCode::wrong_arguments,
            "more shares than points");
}

TEST_F(ShareCommand, DryRunsTellTasksAndWriteNothing) {
    const std::string file = frame();
    const std::size_t before = folder_.file_count();
    const auto dry = [this](Words words) { return done(words + Words{"--dry-run"}); };
    const Words focus = Words{"focus", file, "--method", "lightfield", "--views", "32"} + lens_;
    json said = dry(focus + Words{"-o", in("p.exr"), "--share", "0/3"});
    ASSERT_EQ(said.at("tasks").size(), 3U);
    EXPECT_EQ(said.at("tasks")[1].at("share"), "1/3");
    EXPECT_EQ(said.at("tasks")[1].at("outputs"), json({in("p.part1.exr")}));
    EXPECT_EQ(said.at("merge").size(), 6U);
    said = dry(focus + Words{"-o", in("p.png")});
    EXPECT_EQ(said.at("tasks")[0].at("outputs"), json({in("p.png")}));
    EXPECT_TRUE(said.at("merge").is_null());
    said = dry(Words{"render", scene_, "--size", "32x18", "--spp", "64", "-o", in("r.%03d.exr"), "--frames",
                     "1-5", "--share", "0/2"} +
               lens_);
    EXPECT_EQ(said.at("tasks")[1].at("outputs"), json({in("r.002.exr"), in("r.004.exr")}));
    EXPECT_GT(said.at("tasks")[0].at("seconds"), said.at("tasks")[1].at("seconds"));
    said =
        dry({"sweep", frame(), "--f-number", "1.4,2,2.8", "--focus", "5", "-o", in("s"), "--share", "0/2"});
    EXPECT_EQ(said.at("tasks")[1].at("outputs"), json({in("s/sweep.1-of-2.json")}));
    said = dry({"trace", scene_, "--size", "32x18", "-o", in("t.exr")});
    EXPECT_EQ(said.at("tasks").size(), 1U);
    EXPECT_EQ(folder_.file_count(), before);
    const Words few = Words{"render", scene_, "--size", "16x9", "--spp", "16", "--halves"} + lens_;
    EXPECT_EQ(dry(few + Words{"-o", in("h.exr"), "--share", "0/2"}).at("tasks").size(), 2U);
    const auto two = ExitCode::wrong_arguments;
    refused(few + Words{"-o", in("h.exr"), "--dry-run", "--share", "0/9", "--share-by", "samples"}, two,
            "more shares than the samples");
    refused(few + Words{"-o", in("h.exr"), "--dry-run", "--frames", "1-3"}, two, "no frame number");
    refused(few + Words{"-o", in("none/h.exr"), "--dry-run"}, ExitCode::cannot_write, "no such folder");
    refused(Words{"focus", in("none.exr"), "-o", in("p.exr"), "--dry-run"} + lens_, ExitCode::invalid_input,
            "none.exr");
    refused({"render", scene_, "-o", in("p.exr"), "--spp", "8", "--f-number", "-1", "--dry-run"},
            ExitCode::wrong_arguments, "--f-number");
}

TEST_F(ShareCommand, DryRunsTellTheMemoryWithinAFifth) {
    const Words by_samples{"render", scene_, "--size", "480x270", "--spp", "128", "--share-by", "samples"};
    const Words works[] = {
        Words{"focus", frame(), "--method", "lightfield", "--views", "128"} + lens_,
        Words{"focus", frame(), "--method", "layers"} + lens_,
        {"trace", scene_, "--size", "192x108", "--for-f-number", "1.4"},
        by_samples + lens_,
    };
    for (const Words& words : works) {
        const json said = done(words + Words{"-o", in("p.exr"), "--share", "0/4", "--dry-run"});
        const json real = done(words + Words{"-o", in("p.exr"), "--share", "1/4"});
        const double expected = said.at("tasks")[1].at("memory_bytes"), is = real.at("peak_memory_bytes");
        EXPECT_LT(std::max(expected, is) / std::min(expected, is), 1.2) << words[0] << " " << words[3];
    }
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
        EXPECT_TRUE(bytes_of(in("a" + name)) == bytes_of(in("b" + name))) << i;
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
    // A mark that was changed.
    const auto altered = [&](const std::string& share) {
        std::string all = bytes_of(part("p", 0));
        const std::string mark = R"("share":[0,3])";
        const std::size_t at = all.find(mark);
        EXPECT_NE(at, std::string::npos);
        all.replace(at, mark.size(), R"("share":)" + share);
        std::ofstream(part("altered", 0), std::ios::binary) << all;
        return part("altered", 0);
    };
    refused({"merge", part("p", 0), altered("[1,3]"), part("p", 2), "-o", out}, bad,
            "not those of share 1/3");
    refused({"merge", altered("[3,3]"), "-o", out}, bad, "got share 3/3");
    refused({"merge", altered("[0,1]"), "-o", out}, bad, "not those of share 0/1");
    refused({"merge", altered("[0,0]"), "-o", out}, bad, "got share 0/0");
    std::ofstream(in("no.png")) << "text";
    refused({"merge", in("no.png"), "-o", out}, bad, "no.png: is no part (expected an OpenEXR file that");
    // One changed byte of a pixel.
    std::string changed = bytes_of(part("p", 1));
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
    refused({"trace", scene_, "-o", out, "--size", "8x5", "--share", "0/7"}, two, "more shares than rows");
    refused({"chart", "--atlas", "-o", in("atlas"), "--share", "0/2"}, two, "--share");
}

}  // namespace
}  // namespace postlens::test::share_command_test
