// The options `--pairs` and `--sharp` of `postlens lens fit`.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"

namespace postlens::test::lens_fit_limits_command_test {

using nlohmann::json;

class LensFitLimitsCommand : public CommandTest {};

TEST_F(LensFitLimitsCommand, FindsALensFromPairs) {
    // A 50 mm f/2 lens focused at 1.5 m has a CoC of c = 2500 |z - s| / (2 z (s - F)) mm, given to four
    // decimals.
    std::ofstream(in("pairs.csv"))
        << "distance_m,coc_mm\n0.75,0.8621\n1,0.4310\n3,0.4310\n6,0.6466\ninf,0.8621\n";
    const json j =
        json::parse(run({"lens", "fit", "--pairs", in("pairs.csv"), "--focal-length", "50", "--json"}).out);
    EXPECT_NEAR(j["f_number"], 2, 1e-3);
    EXPECT_NEAR(j["focus_m"], 1.5, 1e-3);
    EXPECT_GT(j["focus_error_m"], 0);
    EXPECT_LT(j["focus_error_m"], 1e-3);
    EXPECT_TRUE(j["focal_length_error_mm"].is_null());
    EXPECT_TRUE(j["warnings"].empty());
    const json free = json::parse(run({"lens", "fit", "--pairs", in("pairs.csv"), "--json"}).out);
    ASSERT_EQ(free["warnings"].size(), 1U);
    EXPECT_EQ(free["warnings"][0]["code"], "undetermined");
}

TEST_F(LensFitLimitsCommand, FindsWhatIsSharp) {
    const json j = json::parse(run({"lens", "fit", "--sharp", "1.2:4", "--sensor", "36x24", "--json"}).out);
    EXPECT_NEAR(j["focus_m"], 2 / (1 / 1.2 + 1 / 4.0), 1e-12);
    EXPECT_NEAR(j["coc_limit_mm"], 43.2666 / 1500, 1e-6);
    EXPECT_TRUE(j["possible"]);
    EXPECT_GT(j["lenses"].size(), 5U);
    const json none = json::parse(
        run({"lens", "fit", "--sharp", "1:3", "--coc-limit", "0.03", "--focal-length", "300", "--json"}).out);
    EXPECT_FALSE(none["possible"]);
    ASSERT_EQ(none["warnings"].size(), 1U);
    EXPECT_NE(none["warnings"][0]["text"].get<std::string>().find("Airy"), std::string::npos);
}

TEST_F(LensFitLimitsCommand, RefusesInOneLine) {
    refused({"lens", "fit"}, ExitCode::wrong_arguments, "nothing to fit");
    refused({"lens", "fit", "--sharp", "1.2"}, ExitCode::wrong_arguments, "--sharp");
    refused({"lens", "fit", "--sharp", "4:1.2", "--coc-limit", "0.03"}, ExitCode::wrong_arguments,
            "NEAR < FAR");
    refused({"lens", "fit", "--sharp", "1.2:4"}, ExitCode::wrong_arguments, "--coc-limit");
    refused({"lens", "fit", "--sharp", "1.2:4", "--sensor", "36"}, ExitCode::wrong_arguments, "--sensor");
    refused({"lens", "fit", "--sharp", "1.2:4", "--sensor", "0x24"}, ExitCode::wrong_arguments, "--sensor");
    refused({"lens", "fit", "--sharp", "nan:4", "--coc-limit", "0.03"}, ExitCode::wrong_arguments, "--sharp");
    refused({"lens", "fit", "--pairs", in("missing.csv")}, ExitCode::invalid_input, "missing.csv");
    std::ofstream(in("pairs.csv")) << "1,0.1\n2,x\n";
    refused({"lens", "fit", "--pairs", in("pairs.csv")}, ExitCode::invalid_input, "pairs.csv:2");
    refused({"lens", "fit", "--pairs", in("pairs.csv"), "--sharp", "1:2"}, ExitCode::wrong_arguments,
            "--pairs");
}

// An option that belongs to another task would have no effect, such as the focus distance that a fit finds.
TEST_F(LensFitLimitsCommand, RefusesOptionsOfOtherTasks) {
    std::ofstream(in("pairs.csv")) << "1,0.1\n2,0.2\n3,0.3\n";
    const std::string lens = std::string(POSTLENS_TEST_DATA) + "/lens/dgauss.22deg.50.0mm.dat";
    const std::vector<std::string> pairs{"--pairs", in("pairs.csv")}, prescription{lens},
        sharp{"--sharp", "1:2", "--sensor", "36x24"};
    for (const auto& [task, option, value, whose] :
         {std::tuple{pairs, "--focus", "7", "a prescription"},
          {pairs, "--sensor", "36x24", "--sharp"},
          {sharp, "--depths", "1:2", "a prescription"},
          {sharp, "--squeeze", "2", "--picture"},
          {prescription, "--impulse", "polygon:5", "--picture"},
          {prescription, "--focal-length", "20", "--pairs"},
          {{"--picture", in("p.exr"), "--frame", in("f.exr")}, "--focus", "2", "a prescription"}}) {
        std::vector<std::string> words{"lens", "fit"};
        words.insert(words.end(), task.begin(), task.end());
        words.insert(words.end(), {option, value});
        refused(words, ExitCode::wrong_arguments, fmt::format("{}: not with", option));
        refused(words, ExitCode::wrong_arguments, fmt::format("expected none, or {})", whose));
    }
}

}  // namespace postlens::test::lens_fit_limits_command_test
