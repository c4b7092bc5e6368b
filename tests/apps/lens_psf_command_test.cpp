// The command `postlens lens psf`.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command_test.h"

namespace postlens::test::lens_psf_command_test {

using nlohmann::json;

class LensPsfCommand : public CommandTest {
  protected:
    static std::vector<std::string> psf(const std::vector<std::string>& more) {
        std::vector<std::string> words = {"lens", "psf"};
        words.insert(words.end(), more.begin(), more.end());
        for (const char* w : {"--focal-length", "50", "--f-number", "8", "--focus", "1", "--depth", "1.1",
                              "--pixel-pitch", "4"}) {
            words.emplace_back(w);
        }
        return words;
    }
    static std::vector<float> pixels(const std::string& path, int& size) {
        Imf::InputFile file(path.c_str());
        const Imf::ChannelList& channels = file.header().channels();
        Imf::ChannelList::ConstIterator channel = channels.begin();
        EXPECT_STREQ(channel.name(), "Y");
        EXPECT_EQ(channel.channel().type, Imf::FLOAT);
        EXPECT_TRUE(++channel == channels.end());
        const Imath::Box2i& window = file.header().dataWindow();
        size = window.max.x - window.min.x + 1;
        EXPECT_EQ(window.max.y - window.min.y + 1, size);
        std::vector<float> values(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
        Imf::FrameBuffer frame;
        frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), window));
        file.setFrameBuffer(frame);
        file.readPixels(window.min.y, window.max.y);
        return values;
    }
};

TEST_F(LensPsfCommand, WritesOneChannelOfEnergyOne) {
    for (const char* impulse : {"disc", "polygon:5", "diffraction", "diffraction:450,550,650"}) {
        const Outcome r = run(psf({in("p.exr"), "--impulse", impulse, "--size", "65", "--json"}));
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const json j = json::parse(r.out);
        int size = 0;
        double sum = 0, peak = 0;
        for (const float value : pixels(in("p.exr"), size)) {
            sum += static_cast<double>(value);
            peak = std::max(peak, static_cast<double>(value));
        }
        EXPECT_EQ(size, 65);
        // Pixels are floats, with a relative rounding of 6e-8.
        EXPECT_NEAR(sum, j["energy_in_frame"], 1e-7) << impulse;
        EXPECT_NEAR(peak, j["peak"], 1e-7 * peak) << impulse;
        EXPECT_GT(sum, 0.985) << impulse;
        EXPECT_LE(sum, 1 + 1e-6) << impulse;
        // The CoC is V D (1/s - 1/z) = 52.63 mm 6.25 mm (1/1 - 1/1.1) / m, divided by pixels of 4 um.
        EXPECT_NEAR(j["coc_px"], 50 / 0.95 * 6.25 * 1e-3 * (1 - 1 / 1.1) / 0.004, 1e-9);
        EXPECT_NEAR(j["u"], 3.14159265358979 * 6.25 * 6.25 / (2 * 550e-6) * (1 - 1 / 1.1) * 1e-3, 1e-7);
    }
}

TEST_F(LensPsfCommand, ProfileEndsAtTheFrameAndHoldsItsEnergy) {
    const Outcome r = run(
        psf({in("p.exr"), "--impulse", "diffraction", "--size", "65", "--profile", in("p.csv"), "--json"}));
    ASSERT_EQ(r.exit_code, 0) << r.err;
    std::istringstream table(bytes_of(in("p.csv")));
    std::string line, last;
    std::getline(table, line);
    EXPECT_EQ(line, "radius_um,radius_px,v,intensity,encircled_energy");
    int rows = 0;
    while (std::getline(table, line)) {
        last = line;
        ++rows;
    }
    EXPECT_GT(rows, 100);
    double um = 0, px = 0, v = 0, intensity = 0, energy = 0;
    ASSERT_EQ(std::sscanf(last.c_str(), "%lf,%lf,%lf,%lf,%lf", &um, &px, &v, &intensity, &energy), 5) << last;
    EXPECT_NEAR(px, 32.5, 1e-9);
    EXPECT_NEAR(um, 130, 1e-9);
    // The circle inscribed in the frame holds less energy than the frame.
    EXPECT_LT(energy, json::parse(r.out)["energy_in_frame"]);
    EXPECT_GT(energy, 0.98);
}

TEST_F(LensPsfCommand, SameBitsForAnyNumberOfThreads) {
    std::string before;
    for (const char* threads : {"1", "7"}) {
        const Outcome r = run(psf({in("p.exr"), "--impulse", "diffraction", "--threads", threads}));
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const std::string bytes = bytes_of(in("p.exr"));
        EXPECT_FALSE(bytes.empty());
        EXPECT_TRUE(before.empty() || before == bytes) << threads;
        before = bytes;
    }
}

TEST_F(LensPsfCommand, CrossoverIsInTextJsonAndTable) {
    const std::vector<std::string> words = {
        "lens", "psf",           "--crossover", "--focal-length", "50",       "--focus", "1", "--depth",
        "1.2",  "--pixel-pitch", "5",           "--profile",      in("c.csv")};
    auto with_json = words;
    with_json.emplace_back("--json");
    const Outcome r = run(with_json);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    // The Airy disc 2.43934 lambda V/F n equals the CoC V/n F (1/s - 1/z) at
    // n = F sqrt((1/s - 1/z) / (2.43934 lambda)).
    EXPECT_NEAR(j["over_defocus_f_number"], 50 * std::sqrt((1 - 1 / 1.2) * 1e-3 / (2.43934 * 550e-6)), 1e-4);
    EXPECT_NEAR(j["over_pixel_f_number"], 0.005 / (2.43934 * 550e-6 / 0.95), 1e-5);
    EXPECT_EQ(bytes_of(in("c.csv")).rfind("f_number,airy_um,coc_um,pixel_um\n", 0), 0U);
    const Outcome text = run(words);
    EXPECT_NE(text.out.find("f/17.62"), std::string::npos) << text.out;
}

TEST_F(LensPsfCommand, RefusesInOneLine) {
    const std::string out = in("p.exr");
    const auto with = [&](const char* option, const char* value) {
        auto words = psf({out});
        const auto at = std::find(words.begin(), words.end(), option);
        if (at != words.end()) {
            *(at + 1) = value;
        } else {
            words.insert(words.end(), {option, value});
        }
        if (std::string_view(option) != "--impulse") words.insert(words.end(), {"--impulse", "diffraction"});
        return words;
    };
    for (const auto& [option, value, part] : {std::tuple{"--f-number", "0", "f-number"},
                                              {"--f-number", "nan", "--f-number"},
                                              {"--f-number", "inf", "pinhole"},
                                              {"--focal-length", "0", "--focal-length"},
                                              {"--focal-length", "-50", "--focal-length"},
                                              {"--focus", "0.05", "focus distance"},
                                              {"--focus", "0.04", "expected more than 0.05 m)"},
                                              {"--focus", "nan", "--focus"},
                                              {"--depth", "0", "depth"},
                                              {"--depth", "-1", "depth"},
                                              {"--wavelength", "99", "wavelength"},
                                              {"--wavelength", "1e9", "wavelength"},
                                              {"--wavelength", "green", "--wavelength"},
                                              {"--pixel-pitch", "0", "--pixel-pitch"},
                                              {"--size", "-1", "size"},
                                              {"--size", "16385", "size"},
                                              {"--size", "2.5", "--size"},
                                              {"--impulse", "gauss", "--impulse"},
                                              {"--impulse", "diffraction:50", "expected 100 to 100000"},
                                              {"--impulse", "diffraction:", "--impulse"}}) {
        refused(with(option, value), ExitCode::wrong_arguments, part);
    }
    refused(psf({out, "--wavelength", "550", "--impulse", "diffraction:480"}), ExitCode::wrong_arguments,
            "--wavelength");
    refused(psf({out, "--cats-eye", "0.5"}), ExitCode::wrong_arguments, "unknown option (got --cats-eye;");
    refused(psf({in("p.png")}), ExitCode::wrong_arguments, ".exr");
    refused(psf({}), ExitCode::wrong_arguments, "OUT");
    for (const Words& unused : {Words{out},
                                {"--f-number", "8"},
                                {"--size", "65"},
                                {"--impulse", "disc"},
                                {"--squeeze", "2"},
                                {"--spherical", "1"}}) {
        const Words crossover{"lens",    "psf", "--crossover", "--focal-length", "50", "--focus", "1",
                              "--depth", "2"};
        refused(crossover + unused, ExitCode::wrong_arguments,
                ": not with --crossover (got " + unused.back() + "; expected none, or a picture OUT.exr)");
    }
    refused({"lens", "psf", out, "--f-number", "8"}, ExitCode::wrong_arguments, "--focal-length");
    refused(psf({in("missing/p.exr")}), ExitCode::cannot_write, "missing");
    refused(with("--profile", in("missing/p.csv").c_str()), ExitCode::cannot_write, "missing");
    for (const char* impulse : {"lens:x.toml", "x"})
        refused(psf({out, "--impulse", impulse}), ExitCode::wrong_arguments, "or image:FILE)");
    refused(psf({out, "--impulse", "image:" + in("missing.png")}), ExitCode::invalid_input, "missing.png");
    refused(psf({out, "--impulse", "polygon:5", "--profile", in("p.csv")}), ExitCode::wrong_arguments,
            "--profile");
    auto vast = with("--f-number", "0.0001");
    vast.insert(vast.end(), {"--size", "16384"});
    *(std::find(vast.begin(), vast.end(), "--pixel-pitch") + 1) = "10000";
    refused(vast, ExitCode::wrong_arguments, "too far out of focus");
    *(std::find(vast.begin(), vast.end(), "--depth") + 1) = "1";
    refused(vast, ExitCode::out_of_memory, "needs");
}

}  // namespace postlens::test::lens_psf_command_test
