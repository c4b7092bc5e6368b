// The command `postlens compare`: its output, its exit codes and the images it writes.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pictures/image.h"
#include "tests/support/command_test.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/flat_exr.h"

namespace postlens::test::compare_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class CompareCommand : public CommandTest {
  protected:
    std::string file(const std::string& name, const Image& image) {
        write_image(in(name), image);
        return in(name);
    }
    Outcome run(std::vector<std::string> words, const std::string& before = "") {
        words.insert(words.begin(), "compare");
        return CommandTest::run(words, before);
    }
    json run_json(std::vector<std::string> words, int exit_code = 0) {
        words.emplace_back("--json");
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        return json::parse(r.out);
    }
    void refused(const std::vector<std::string>& words, int code, const std::string& part) {
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, code) << r.err;
        EXPECT_EQ(r.err.rfind("postlens: ", 0), 0U) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
        EXPECT_TRUE(r.out.empty()) << r.out;
    }
    static std::vector<std::string> codes(const json& result) {
        std::vector<std::string> out;
        for (const json& w : result.at("warnings")) out.push_back(w.at("code"));
        return out;
    }
};

TEST_F(CompareCommand, ACropIsComparedAlone) {
    Image image = constant_picture(40, 30, 0.5F);
    const std::string reference = file("r.exr", image);
    std::fill_n(image.pixel(20, 12), 3, 0.75F);
    const std::string wrong = file("w.exr", image);
    const json inside = run_json({wrong, reference, "--crop", "20,12,16,16", "--map", in("m.png")});
    EXPECT_NEAR(inside["rmse"], 0.25 / 16, 1e-9);  // one of 16 x 16 pixels
    EXPECT_EQ(run_json({wrong, reference, "--crop", "21,12,16,16"})["rmse"], 0);
    refused({wrong, reference, "--crop", "30,12,16,16"}, 2, "--crop");
    refused({wrong, reference, "--crop", "20,12,16,16", "--frame", reference, "--map-causes", in("c.png")}, 2,
            "--crop: not with --map-causes");
}

TEST_F(CompareCommand, ACutPngIsOneError) {
    const std::string whole = file("a.png", constant_picture(40, 30, 0.75F)), cut = in("cut.png");
    std::ofstream(cut, std::ios::binary) << bytes_of(whole).substr(0, bytes_of(whole).size() - 20);
    refused({cut, whole}, 3, "cut.png: cannot read (");
}

TEST_F(CompareCommand, SaysEveryFigure) {
    const std::string a = file("a.exr", constant_picture(40, 30, 0.75F));
    const std::string b = file("b.exr", constant_picture(40, 30, 0.5F));
    const json j = run_json({a, b});
    EXPECT_EQ(j.at("rmse"), 0.25);
    EXPECT_NEAR(j.at("relmse"), 0.0625 / 0.26, 1e-12);
    EXPECT_NEAR(j.at("relmse_trimmed"), 0.0625 / 0.26, 1e-12);
    EXPECT_GT(j.at("psnr_db"), 10);
    EXPECT_LT(j.at("ssim"), 1);
    EXPECT_GT(j.at("flip"), 0);
    EXPECT_EQ(j.at("flip"), j.at("flip_ldr"));
    for (const char* key : {"affected_share", "affected_psnr_db", "noise_psnr_db", "psnr_above_noise_db"})
        EXPECT_TRUE(j.at(key).is_null()) << key;
    EXPECT_EQ(j.at("identical"), false);
    const Outcome text = run({a, b});
    for (const char* word : {"PSNR", "RMSE", "relMSE", "trimmed", "SSIM", "FLIP", "whole frame"})
        EXPECT_NE(text.out.find(word), std::string::npos) << text.out;
    EXPECT_TRUE(run({a, b, "--quiet"}).out.empty());
}

TEST_F(CompareCommand, EqualPicturesHaveNoPsnrButAreIdentical) {
    const std::string a = file("a.exr", waves(40, 30));
    const json j = run_json({a, a, "--fail-psnr", "1000", "--fail-relmse", "0", "--fail-flip", "0"});
    EXPECT_TRUE(j.at("psnr_db").is_null());
    EXPECT_EQ(j.at("identical"), true);
    EXPECT_EQ(j.at("rmse"), 0);
    EXPECT_EQ(j.at("ssim"), 1);
    EXPECT_EQ(j.at("flip"), 0);
    const std::string black = file("black.exr", Image(64, 64));
    const json dark = run_json({black, black});
    EXPECT_EQ(dark.at("flip_hdr"), 0);
}

TEST_F(CompareCommand, AMissedLimitIsOneAndTheResultIsStillThere) {
    const std::string a = file("a.exr", constant_picture(40, 30, 0.75F));
    const std::string b = file("b.exr", constant_picture(40, 30, 0.5F));
    const double psnr = run_json({a, b}).at("psnr_db");
    EXPECT_EQ(run({a, b, "--fail-psnr", std::to_string(psnr - 0.01)}).exit_code, 0);
    const std::vector<std::pair<std::string, std::string>> limits{
        {"--fail-psnr", std::to_string(psnr + 0.01)}, {"--fail-relmse", "0.24"}, {"--fail-flip", "0.01"}};
    for (const auto& [option, value] : limits) {
        const Outcome r = run({a, b, option, value});
        EXPECT_EQ(r.exit_code, 1) << option;
        EXPECT_NE(r.out.find("whole frame"), std::string::npos);
        EXPECT_NE(r.out.find("FAILED: "), std::string::npos);
        EXPECT_EQ(run_json({a, b, option, value}, 1).at("failed").size(), 1U);
    }
}

TEST_F(CompareCommand, WrongArgumentsAreTwo) {
    const std::string a = file("a.exr", waves(16, 16));
    refused({a}, 2, "REFERENCE: missing");
    for (const char* option : {"--fail-psnr", "--fail-relmse", "--fail-flip"}) {
        refused({a, a, option, "nan"}, 2, option);
        refused({a, a, option, "-1"}, 2, option);
        refused({a, a, option, "inf"}, 2, option);
        refused({a, a, option, "x"}, 2, option);
    }
    refused({a, a, "--fail-flip", "1.5"}, 2, "--fail-flip");
    refused({a, a, "--flip-white", "0"}, 2, "--flip-white");
    refused({a, a, "--map", in("map.xyz")}, 2, "map.xyz");
}

TEST_F(CompareCommand, UnreadableInputIsThree) {
    const std::string a = file("a.exr", waves(40, 30)), other = file("other.exr", waves(30, 40));
    refused({in("none.exr"), a}, 3, "none.exr");
    refused({a, in("none.exr")}, 3, "none.exr");
    refused({a, in(".")}, 3, "cannot read");
    const Outcome sizes = run({a, other});
    EXPECT_NE(sizes.err.find("40x30"), std::string::npos);
    EXPECT_NE(sizes.err.find("30x40"), std::string::npos);
    refused({a, other}, 3, "size differs");
    refused({a, a, "--noise", other}, 3, "size differs");
    refused({a, a, "--pinhole", other}, 3, "size differs");
    refused({a, POSTLENS_TEST_DATA "/exr/deep_one_sample.exr"}, 3, "deep");
    const std::string whole = bytes_of(a);
    for (const double share : {0.0, 0.1, 0.5, 0.9}) {
        std::ofstream(in("cut.exr"), std::ios::binary)
            << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
        refused({in("cut.exr"), a}, 3, "cut.exr");
    }
}

TEST_F(CompareCommand, UnwritableMapsAreFour) {
    const std::string a = file("a.exr", waves(40, 30));
    EXPECT_EQ(run({a, a, "--map", in("no/such/map.png")}).exit_code, 4);
}

// Sanitizers reserve more address space than any limit that would be meaningful here.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(CompareCommand, TooLittleMemoryIsFiveAndSaysHowMuchIsNeeded) {
    // The libraries and the images take about 400 MB of address space, the comparison another 446 MB.
    // The file has a small data window, so that it is written and read quickly.
    const std::string a = in("a.exr");
    write_flat_exr(a, {"R", "G", "B"}, {0, 0, 16, 16}, {0, 0, 2600, 2000},
                   [](int, int) { return std::vector<float>(3); });
    const Outcome r = run({a, a, "--threads", "1"}, "ulimit -v 600000; ");
    EXPECT_EQ(r.exit_code, 5) << r.err;
    EXPECT_NE(r.err.find("2600x2000 pixels (needs about 446 MB)"), std::string::npos) << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
}
#endif

TEST_F(CompareCommand, NonfinitePixelsAreSaidAndFailLimits) {
    Image image = waves(40, 30), reference = waves(40, 30);
    image.pixel(3, 3)[0] = std::numeric_limits<float>::quiet_NaN();
    const std::string a = file("a.exr", image), b = file("b.exr", reference);
    const json j = run_json({a, b});
    EXPECT_EQ(j.at("nonfinite_pixels"), 1);
    EXPECT_EQ(codes(j), std::vector<std::string>{"nonfinite"});
    EXPECT_NEAR(j.at("warnings")[0].at("share"), 1.0 / 1200, 1e-12);
    EXPECT_EQ(run({a, b, "--fail-psnr", "10"}).exit_code, 1);
    EXPECT_EQ(run({b, a, "--fail-psnr", "10"}).exit_code, 0);  // NaN in the reference is no failure
}

TEST_F(CompareCommand, PinholeAndNoise) {
    const Image truth = waves(160, 120);
    const std::string a = file("a.exr", noisy(truth, 0.02, 3)), r1 = file("r1.exr", noisy(truth, 0.01, 1)),
                      r2 = file("r2.exr", noisy(truth, 0.01, 2)),
                      pinhole = file("p.exr", noisy(truth, 0.1, 4));
    const json j = run_json({a, r1, "--noise", r2, "--pinhole", pinhole});
    EXPECT_GT(j.at("affected_share"), 0.9);
    for (const char* key :
         {"affected_psnr_db", "noise_psnr_db", "affected_noise_psnr_db", "psnr_above_noise_db",
          "affected_psnr_above_noise_db", "pinhole_psnr_db", "rmse_above_noise", "relmse_above_noise"})
        EXPECT_TRUE(j.at(key).is_number()) << key;
    EXPECT_EQ(j.at("psnr_above_noise_is_bound"), false);
    EXPECT_GT(j.at("psnr_above_noise_db"), j.at("psnr_db"));
    // The tolerance is four standard errors of an RMS of 0.02 over 57600 values, including the noise.
    EXPECT_NEAR(j.at("rmse_above_noise"), 0.02, 4 * 0.02 / std::sqrt(2 * 57600.0) * 1.5);
    EXPECT_TRUE(codes(j).empty());
    EXPECT_NE(run({a, r1, "--noise", r2}).out.find("the reference itself is good to"), std::string::npos);
    EXPECT_EQ(codes(run_json({a, r1, "--noise", r1})), std::vector<std::string>{"same_reference"});
    EXPECT_EQ(codes(run_json({r1, r1, "--noise", r2})), std::vector<std::string>{"image_is_reference"});
    EXPECT_TRUE(run_json({r2, r1, "--noise", r2}).at("psnr_above_noise_db").is_null());
    const std::string made_from_r1 = file("m.exr", noisy(noisy(truth, 0.01, 1), 0.003, 9));
    EXPECT_EQ(codes(run_json({made_from_r1, r1, "--noise", r2})).front(), "unlike_references");
}

TEST_F(CompareCommand, MapAndSideBySideArePictures) {
    const std::string a = file("a.exr", waves(500, 100)), b = file("b.png", waves(500, 100));
    ASSERT_EQ(run({a, b, "--map", in("map.png"), "--side-by-side", in("both.png")}).exit_code, 0);
    EXPECT_EQ(read_image_size(in("map.png")), (ImageSize{500, 100 + 60}));  // the legend is 60 px high
    // From top to bottom: name, gap, map, gap, two rows of figures and a note, gap; px.
    EXPECT_EQ(read_image_size(in("both.png")), (ImageSize{3 * 500 + 4 * 8, 18 + 8 + 160 + 8 + 3 * 18 + 8}));
    EXPECT_EQ(folder_.file_count(), 4U);
}

TEST_F(CompareCommand, TheDisplayWindowIsWhatIsCompared) {
    // The file holds only the middle of the image, in a data window smaller than the display window.
    const Image whole = waves(40, 30);
    const std::string a = file("a.exr", whole), part = in("part.exr");
    write_flat_exr(part, {"R", "G", "B"}, {10, 5, 20, 10}, {0, 0, 40, 30}, [&](int x, int y) {
        return std::vector<float>(whole.pixel(x, y), whole.pixel(x, y) + 3);
    });
    const Image back = read_image(part);
    ASSERT_EQ(back.width, 40);
    ASSERT_EQ(back.height, 30);
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
            const bool stored = x >= 10 && x < 30 && y >= 5 && y < 15;
            EXPECT_EQ(back.pixel(x, y)[0], stored ? whole.pixel(x, y)[0] : 0.0F);
        }
    }
    EXPECT_EQ(run_json({part, a}).at("width"), 40);
}

TEST_F(CompareCommand, ASampleFileIsItsPinholePicture) {
    const std::string frame = in("frame.exr"), picture = in("picture.exr");
    const std::string scene = POSTLENS_TEST_DATA "/nff/balls_s2.nff";
    const std::string program = "'" POSTLENS_BINARY "' ";
    ASSERT_EQ(std::system((program + "trace '" + scene + "' -o '" + frame +
                           "' --size 48x48 --metres-per-unit 0.1 --overscan 6 --quiet && " + program +
                           "image '" + frame + "' -o '" + picture + "' --quiet")
                              .c_str()),
              0);
    EXPECT_EQ(run_json({frame, picture}).at("identical"), true);
}

}  // namespace
}  // namespace postlens::test::compare_command_test
