// The commands `lens show`, `lens trace` and `lens fit`.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "pictures/image.h"
#include "tests/support/command_test.h"

namespace postlens::test::lens_command_test {
namespace {

using nlohmann::json;

class LensCommand : public CommandTest {
  protected:
    static std::string data(const std::string& name) {
        return std::string(POSTLENS_TEST_DATA "/lens/") + name;
    }
    json result(std::vector<std::string> words) {
        words.emplace_back("--json");
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return json::parse(r.out);
    }
    std::string sample_ = POSTLENS_SAMPLES "/lenses/double_gauss.toml";
};

TEST_F(LensCommand, ShowHasItsKeys) {
    const json j = result({"lens", "show", data("rayoptics_ag_dblgauss.seq"), "--film-width", "40"});
    // The values of CODE V's listing, with four decimals.
    EXPECT_NEAR(j["efl_mm"], 100.0038, 1e-4);
    EXPECT_NEAR(j["bfl_mm"], 61.4875, 1e-4);
    EXPECT_NEAR(j["ffl_mm"], -29.3208, 1e-4);
    EXPECT_NEAR(j["f_number"], 2.0001, 1e-4);
    EXPECT_NEAR(j["entrance_pupil_diameter_mm"], 50, 1e-9);
    EXPECT_NEAR(j["entrance_pupil_z_mm"], 57.9120, 1e-4);
    EXPECT_NEAR(j["exit_pupil_diameter_mm"], 57.3201, 1e-4);
    EXPECT_NEAR(j["exit_pupil_z_mm"], -53.1569, 1e-4);
    EXPECT_NEAR(j["field_of_view_deg"], 2 * std::atan(20 / 100.0038) * 180 / 3.14159265358979, 1e-4);
    // The design has its film 0.4 mm in front of the focus, and 0.6 % of barrel distortion. Both widen the
    // field of view.
    EXPECT_NEAR(j["field_of_view_traced_deg"].get<double>() / j["field_of_view_deg"].get<double>(), 1.010,
                0.002);
    // The sample is the same design with rounded radii.
    EXPECT_NEAR(result({"lens", "show", sample_})["efl_mm"], 100.0038, 1e-3);
    const json stopped = result({"lens", "show", sample_, "--f-number", "8", "--focus", "2"});
    EXPECT_NEAR(stopped["f_number"], 8, 1e-9);
    EXPECT_NEAR(stopped["entrance_pupil_diameter_mm"], 12.5, 1e-2);
    EXPECT_GT(stopped["film_distance_mm"], 65);
}

TEST_F(LensCommand, ShowDraws) {
    EXPECT_EQ(run({"lens", "show", sample_, "-o", in("a.svg")}).exit_code, 0);
    const std::string svg = bytes_of(in("a.svg"));
    EXPECT_EQ(svg.rfind("<svg", 0), 0U);
    std::size_t polygons = 0;
    for (std::size_t at = 0; (at = svg.find("<polygon", at)) != std::string::npos; ++at) ++polygons;
    EXPECT_EQ(polygons, 6U);
    EXPECT_EQ(run({"lens", "show", sample_, "-o", in("a.png")}).exit_code, 0);
    const Image picture = read_image(in("a.png"));
    EXPECT_EQ(picture.width, 1200);
    std::size_t dark = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) dark += picture.rgb[i] < 0.5F ? 1 : 0;
    EXPECT_GT(dark, 3000U);
}

TEST_F(LensCommand, ShowWarnsOfWhatTheFileDoesNotHave) {
    const json j = result({"lens", "show", data("wide.40deg.100.0mm.dat")});
    ASSERT_EQ(j["warnings"].size(), 1U);
    EXPECT_EQ(j["warnings"][0]["code"], "stated_focal_length");
    EXPECT_TRUE(result({"lens", "show", data("dgauss.22deg.50.0mm.dat")})["warnings"].empty());
}

TEST_F(LensCommand, TraceWritesItsFiles) {
    const json j = result({"lens", "trace", sample_, "--focus", "2", "--fields", "0,8", "--rays", "33", "-o",
                           in("s.csv"), "--curves", in("c.csv"), "--impulse", in("i.exr")});
    ASSERT_EQ(j["fields"].size(), 2U);
    EXPECT_EQ(j["fields"][0]["film_mm"], 0);
    EXPECT_EQ(j["fields"][0]["pupil_share"], 1);
    EXPECT_GT(j["fields"][1]["film_mm"], 13);
    EXPECT_LT(j["fields"][1]["pupil_share"], 1);
    std::ifstream spots(in("s.csv"));
    std::string line;
    std::size_t rows = 0;
    while (std::getline(spots, line)) ++rows;
    EXPECT_EQ(rows, 1U + 2U * 33U * 33U);
    const Image impulse = read_image(in("i.exr"));
    EXPECT_EQ(impulse.width, 2 * impulse.height);
    double sum = 0;
    for (std::size_t i = 0; i < impulse.rgb.size(); i += 3) sum += static_cast<double>(impulse.rgb[i]);
    EXPECT_NEAR(sum, 2, 1e-4);
    std::ifstream curves(in("c.csv"));
    std::getline(curves, line);
    EXPECT_EQ(line, "field_deg,film_mm,distortion_percent,pupil_share,relative_illumination");
    std::getline(curves, line);
    EXPECT_EQ(line.rfind("0,", 0), 0U);
}

// A chief ray at 89 degrees misses the lens. The exit pupil of a stop on the last surface is the stop.
TEST_F(LensCommand, NumbersAreNumbers) {
    const std::string ball = in("biconvex.toml");
    std::ofstream(ball)
        << "[lens]\nf_number = 4\n[[surface]]\nradius_mm = 50\nthickness_mm = 5\nindex = 1.5\n"
           "[[surface]]\nstop = true\nradius_mm = -50\n";
    const Outcome trace = run({"lens", "trace", ball, "--fields", "0,89"}),
                  show = run({"lens", "show", ball});
    EXPECT_NE(trace.out.find("89.000 degrees: no chief ray, RMS radius"), std::string::npos) << trace.out;
    EXPECT_EQ(trace.out.find("nan"), std::string::npos) << trace.out;
    EXPECT_NE(show.out.find("at 0 mm from the last surface"), std::string::npos) << show.out;
}

TEST_F(LensCommand, TraceDrawsTheSameForAnyThreads) {
    EXPECT_EQ(run({"lens", "trace", sample_, "-o", in("a.png"), "--curves", in("a.svg"), "--threads", "1"})
                  .exit_code,
              0);
    EXPECT_EQ(run({"lens", "trace", sample_, "-o", in("b.png"), "--curves", in("b.svg"), "--threads", "3"})
                  .exit_code,
              0);
    EXPECT_EQ(bytes_of(in("a.png")), bytes_of(in("b.png")));
    EXPECT_EQ(bytes_of(in("a.svg")), bytes_of(in("b.svg")));
    EXPECT_GT(bytes_of(in("a.svg")).size(), 2000U);
}

TEST_F(LensCommand, FitPicksTheCheapest) {
    const std::vector<std::string> words{"lens",  "fit",     sample_, "--focus",   "3", "--depths",
                                         "1:inf", "--field", "12",    "--samples", "4"};
    const auto with = [&](const char* tolerance) {
        auto all = words;
        all.insert(all.end(), {"--tolerance-px", tolerance});
        return result(all);
    };
    const json loose = with("1000"), tight = with("1e-9");
    EXPECT_EQ(loose["picked"], "thin");
    EXPECT_EQ(tight["picked"], "traced");
    ASSERT_EQ(loose["models"].size(), 4U);
    EXPECT_EQ(loose["depths_m"].size(), 7U);  // the four of the fit, and three between them
    EXPECT_EQ(loose["models"][3]["error_px"], 0);
    EXPECT_LT(loose["models"][2]["error_px"], loose["models"][1]["error_px"]);
    EXPECT_EQ(loose["polynomial"]["x_mm"].size(), 26U);
    EXPECT_TRUE(loose["depths_m"].back().is_null());
}

TEST_F(LensCommand, InfoKnowsPrescriptions) {
    for (const std::string& file :
         {sample_, data("dgauss.22deg.50.0mm.dat"), data("rayoptics_ag_dblgauss.seq")}) {
        const json j = result({"info", file});
        EXPECT_EQ(j["kind"], "lens") << file;
        EXPECT_EQ(j["surfaces"], 11) << file;
    }
}

TEST_F(LensCommand, BadRequestsAreRefused) {
    const auto wrong = ExitCode::wrong_arguments, invalid = ExitCode::invalid_input;
    refused({"lens", "show", in("none.toml")}, invalid, "no such file");
    refused({"lens", "show", sample_, "--f-number", "0"}, wrong, "--f-number: out of range (got 0");
    refused({"lens", "show", sample_, "--f-number", "1.4"}, wrong, "which");
    refused({"lens", "show", sample_, "--focus", "0"}, wrong, "--focus: out of range");
    refused({"lens", "show", sample_, "--focus", "0.05"}, wrong, "--focus: too near");
    refused({"lens", "show", sample_, "--film-width", "0"}, wrong, "--film-width");
    refused({"lens", "show", sample_, "--wavelength", "5"}, wrong, "--wavelength");
    refused({"lens", "show", sample_, "-o", in("a.xyz")}, wrong, "a.xyz");
    refused({"lens", "show", sample_, "-o", in("no/a.svg")}, ExitCode::cannot_write, "does not exist");
    refused({"lens", "trace", sample_, "--fields", "0,x"}, wrong, "--fields: not a number (got x");
    refused({"lens", "trace", sample_, "--fields", "90"}, wrong, "--fields: out of range");
    refused({"lens", "trace", sample_, "--depth", "-1"}, wrong, "--depth: out of range");
    refused({"lens", "trace", sample_, "--rays", "1"}, wrong, "--rays");
    refused({"lens", "trace", sample_, "--pixel-pitch", "0"}, wrong, "--pixel-pitch");
    refused({"lens", "trace", sample_, "--impulse", in("i.png")}, wrong, "responses are written as OpenEXR");
    refused({"lens", "fit", sample_, "--depths", "2:1"}, wrong, "--depths");
    refused({"lens", "fit", sample_, "--depths", "2"}, wrong, "--depths");
    // The entrance pupil, from which depths are measured, is 57.9 mm behind the first surface.
    refused({"lens", "fit", sample_, "--depths", "0.03:1"}, wrong, "--depths: within the lens (got 0.03 m;");
    refused({"lens", "trace", sample_, "--depth", "0.03"}, wrong, "expected more than 0.0579");
    EXPECT_EQ(run({"lens", "trace", sample_, "--depth", "0.06"}).exit_code, 0);
    // A polynomial with terms up to the fifth power of the field needs three fields off the axis.
    refused({"lens", "fit", sample_, "--samples", "3"}, wrong, "--samples: out of range");
    refused({"lens", "fit", sample_, "--tolerance-px", "0"}, wrong, "--tolerance-px");
    refused({"lens", "fit", sample_, "--field", "900"}, wrong, "--field: no chief ray");
    // An aperture of a picometre, which no ray passes.
    const std::string dark = in("dark.dat");
    std::ofstream(dark) << "50 5 1.5 20\n-50 5 1 20\n0 20 1 10\n80 3 1.5 0.000000001\n-80 0 1 20\n";
    refused({"lens", "trace", dark}, invalid, "no ray gets");
    const std::string negative = in("negative.dat");
    std::ofstream(negative) << "-50 5 1.5 20\n50 5 1 20\n0 0 1 10\n";
    EXPECT_EQ(run({"lens", "show", negative}).exit_code, 0);
    refused({"lens", "trace", negative}, invalid, "forms no real image");
}

}  // namespace
}  // namespace postlens::test::lens_command_test
