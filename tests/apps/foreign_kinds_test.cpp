// Kinds of files of other programs that users reported as misread, on the command line, with their correct
// values (tests/data/exr/README.md).
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/unmix_edges.h"
#include "tests/support/command_test.h"
#include "tests/support/flat_exr.h"

namespace postlens::test::foreign_kinds_test {
namespace {

using nlohmann::json;

constexpr float to = 1e-3F;  ///< tolerance that the reports require

std::string data(const std::string& name) {
    return std::string(POSTLENS_TEST_DATA "/exr/") + name + ".exr";
}

struct Plane {
    int width = 0, height = 0;
    PixelValues values;
    std::vector<std::string> channels;

    void write(const std::string& path) const { write_flat_exr(path, channels, width, height, values); }
};

class ForeignKinds : public CommandTest {
  protected:
    json done(Words words) {
        words.emplace_back("--json");
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    /// Runs `focus` and returns its image; the command's JSON output is stored in `said_`.
    Image focus(const std::string& file, const Words& more) {
        Words words{"focus", file,           "-o", in("o.exr"),         "--focal-length",
                    "50",    "--film-width", "36", "--metres-per-unit", "1",
                    "--z",   "axial"};
        words.insert(words.end(), more.begin(), more.end());
        said_ = done(words);
        return read_foreign_picture(in("o.exr"), {}, {}).flattened();
    }
    Image flattened(const std::string& file) {
        done({"image", file, "-o", in("i.exr")});
        return read_foreign_picture(in("i.exr"), {}, {}).flattened();
    }
    [[nodiscard]] bool warned(const std::string& words) const {
        for (const json& w : said_.at("warnings")) {
            if (w.at("text").get<std::string>().find(words) != std::string::npos) return true;
        }
        return false;
    }
    static void expect_colour(const Image& image, int x, int y, const std::array<float, 3>& rgb) {
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(image.pixel(x, y)[c], rgb[c], to) << x << "," << y << " channel " << c;
    }
    static float alpha_at(const Image& image, std::size_t pixel) {
        return image.alpha.empty() ? 1 : image.alpha[pixel];
    }
    /// The greatest difference of two images, in colours and alpha.
    static float difference(const Image& a, const Image& b) {
        EXPECT_EQ(a.rgb.size(), b.rgb.size());
        float most = 0;
        for (std::size_t i = 0; i < std::min(a.rgb.size(), b.rgb.size()); ++i) {
            most = std::max(most, std::abs(a.rgb[i] - b.rgb[i]));
            if (i % 3 == 0) most = std::max(most, std::abs(alpha_at(a, i / 3) - alpha_at(b, i / 3)));
        }
        return most;
    }
    json said_;
};

const Words both_methods{"scatter", "layers"};

TEST_F(ForeignKinds, LuminanceAndChromaAreColours) {
    for (const char* file : {"yc", "yca"}) {
        const std::string path = data(std::string("luminance_chroma/") + file);
        for (const Image& image : {flattened(path), focus(path, {"--f-number", "2", "--focus", "4"})}) {
            expect_colour(image, 6, 12, {0.8F, 0.1F, 0.1F});
            expect_colour(image, 26, 12, {0.1F, 0.2F, 0.7F});
        }
    }
    const Image grey = flattened(data("luminance_chroma/grey"));
    expect_colour(grey, 6, 12, {0.249F, 0.249F, 0.249F});
    expect_colour(grey, 26, 12, {0.215F, 0.215F, 0.215F});
    const Outcome few = run({"image", data("luminance_chroma/quarter_depth"), "-o", in("o.exr")});
    EXPECT_EQ(few.exit_code, 3);
    EXPECT_NE(few.err.find("channel Z is subsampled (got 2x2; expected"), std::string::npos) << few.err;
}

TEST_F(ForeignKinds, LayersAreFoundByTheWordsOfTheirNames) {
    for (const char* file : {"parts", "swapped", "dots", "one", "words", "words_layer"}) {
        const std::string path = data(std::string("layer_names/") + file);
        expect_colour(flattened(path), 3, 8, {0.7F, 0.4F, 0.2F});
        focus(path, {"--f-number", "2.8", "--focus-at", "20,8"});
        EXPECT_EQ(said_.at("focus_m"), 8) << file;
        EXPECT_FALSE(warned("depth")) << file;
    }
}

TEST_F(ForeignKinds, NamesMayHaveAnyBytes) {
    const auto picture = [&](const std::string& depth) {
        Plane{2,
              1,
              [](int, int) {
                  return std::vector<float>{0.5F, 0.5F, 0.5F, 4};
              },
              {"R", "G", "B", depth}}
            .write(in("names.exr"));
    };
    picture("caf\xE9.Z");  // Latin-1
    EXPECT_EQ(done({"info", in("names.exr")}).at("colour").at("depth"), "caf\uFFFD.Z");
    focus(in("names.exr"), {"--f-number", "2", "--focus", "2"});
    EXPECT_TRUE(warned("caf\uFFFD.Z"));
    picture("a\nb.Z");
    const Outcome r = run({"image", in("names.exr"), "-o", in("o.exr")});
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.err.find("warning: a?b.Z"), std::string::npos) << r.err;
}

TEST_F(ForeignKinds, ErrorsSayWhyACryptomatteIsNotUsed) {
    Plane{2,
          1,
          [](int, int) {
              return std::vector<float>{0.5F, 0.5F, 0.5F, 4, 1};
          },
          {"R", "G", "B", "Z", "crypto00.R"}}
        .write(in("half.exr"));
    for (const Words& option : {Words{"--passes", "cryptomatte"}, {"--holdout", "bar"}}) {
        Words words{"focus", in("half.exr"), "-o", in("o.exr"), "--f-number", "2", "--focus", "2"};
        words.insert(words.end(), option.begin(), option.end());
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 2) << option[0];
        EXPECT_NE(r.err.find("Cryptomatte crypto is not used: no channels crypto00.R and crypto00.G"),
                  std::string::npos)
            << r.err;
    }
}

TEST_F(ForeignKinds, DepthsMayBeInverse) {
    const Words lens{"--f-number", "1", "--focus", "2"};
    const Image wanted = focus(data("inverse_depth/distance"), lens);
    focus(data("inverse_depth/inverse"), lens);
    EXPECT_TRUE(warned("--depth-encoding"));
    Words told = lens;
    told.insert(told.end(), {"--depth-encoding", "inverse"});
    const Image image = focus(data("inverse_depth/inverse"), told);
    EXPECT_FALSE(warned("--depth-encoding"));
    EXPECT_LE(difference(image, wanted), to);
    const Image pinhole = flattened(data("inverse_depth/distance"));
    for (int y = 8; y < 40; ++y) {
        for (int x = 8; x < 24; ++x)
            expect_colour(image, x, y,
                          {pinhole.pixel(x, y)[0], pinhole.pixel(x, y)[1], pinhole.pixel(x, y)[2]});
    }
}

// Normalised depths v: z = NEAR + v (FAR - NEAR), or with 1 - v in files in which near is white.
TEST_F(ForeignKinds, DepthsMayBeNormalized) {
    const auto picture = [](const std::function<float(float)>& encoded) {
        return Plane{64,
                     16,
                     [encoded](int x, int y) {
                         const float shade = 0.2F + 0.5F * static_cast<float>((x / 2 + y / 2) % 2);
                         return std::vector<float>{shade, 0.5F, 1 - shade, encoded(x < 32 ? 2.0F : 7.0F)};
                     },
                     {"R", "G", "B", "Z"}};
    };
    picture([](float z) { return z; }).write(in("z.exr"));
    picture([](float z) { return (z - 1) / 9; }).write(in("near_black.exr"));
    picture([](float z) { return (10 - z) / 9; }).write(in("near_white.exr"));
    const Words lens{"--f-number", "1", "--focus", "2"};
    const Image wanted = focus(in("z.exr"), lens);
    for (const auto& [file, planes] : {std::pair("near_black", "1,10"), {"near_white", "10,1"}}) {
        Words told = lens;
        told.insert(told.end(), {"--depth-encoding", std::string("normalized:") + planes});
        EXPECT_LE(difference(focus(in(std::string(file) + ".exr"), told), wanted), to) << file;
    }
    for (const char* wrong :
         {"log", "normalized", "normalized:1", "normalized:2,2", "normalized:-1,2", "1,2"}) {
        const Outcome r = run({"focus", in("z.exr"), "-o", in("o.exr"), "--f-number", "1", "--focus", "2",
                               "--depth-encoding", wrong});
        EXPECT_EQ(r.exit_code, 2) << wrong;
        EXPECT_NE(r.err.find("--depth-encoding"), std::string::npos) << r.err;
    }
}

TEST_F(ForeignKinds, DepthsTimesCoverageAreDivided) {
    for (const std::string& method : both_methods) {
        for (const char* file : {"nearest", "premultiplied"}) {
            const std::string path = data(std::string("filtered_depth/") + file);
            const Image image = focus(path, {"--f-number", "0.5", "--focus", "3", "--method", method});
            EXPECT_LE(difference(image, flattened(path)), to) << file << " " << method;
            EXPECT_EQ(warned("multiplied by alpha"), std::string(file) == "premultiplied") << file;
        }
    }
}

/// Coverage of a pixel by a disc about `middle`, from 8 x 8 positions in the pixel.
double coverage(int x, int y, double middle, double radius) {
    int inside = 0;
    for (int v = 0; v < 8; ++v) {
        for (int u = 0; u < 8; ++u)
            inside += std::hypot(x + (u + 0.5) / 8 - middle, y + (v + 0.5) / 8 - middle) < radius ? 1 : 0;
    }
    return inside / 64.0;
}

// Pixels at the rim of a disc have means of depths and colours of disc and wall, with equal coverages. After
// unmixing, the disc in focus stays unchanged, and the uniform wall behind it stays uniform.
TEST_F(ForeignKinds, DepthsThatAreMeansGoToBothSides) {
    const auto picture = [](bool mean) {
        return Plane{64,
                     64,
                     [mean](int x, int y) {
                         const double share = coverage(x, y, 32, 17.3);
                         const auto mix = [&](double disc, double wall) {
                             return static_cast<float>(share * disc + (1 - share) * wall);
                         };
                         const float z = mean ? mix(3, 12) : share >= 0.5 ? 3.0F : 12.0F;
                         return std::vector<float>{mix(0.9, 0.1), mix(0.2, 0.3), mix(0.1, 0.8), z};
                     },
                     {"R", "G", "B", "Z"}};
    };
    picture(true).write(in("mean.exr"));
    picture(false).write(in("most.exr"));
    // Unmixing these pixels gives the disc and the wall again.
    ForeignPicture apart = read_foreign_picture(in("mean.exr"), {}, {});
    std::size_t mixed = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) mixed += std::fmod(coverage(x, y, 32, 17.3), 1) > 0 ? 1 : 0;
    }
    EXPECT_EQ(unmix_edges(apart), mixed);
    for (const StackSample& s : apart.samples) {
        const bool disc = s.inverse_z > 0.2F;
        EXPECT_NEAR(s.inverse_z, disc ? 1 / 3.0 : 1 / 12.0, 1e-6);
        EXPECT_NEAR(s.r / s.alpha, disc ? 0.9 : 0.1, 1e-5);
        EXPECT_NEAR(s.b / s.alpha, disc ? 0.1 : 0.8, 1e-5);
    }
    // With the disc in focus the image stays unchanged, except for the error of `layers` at slanted edges: up
    // to 0.4 %, as at edges from a Cryptomatte.
    const Words lens{"--f-number", "0.5", "--focus", "3", "--method", "layers"};
    const Image image = focus(in("mean.exr"), lens), pinhole = flattened(in("mean.exr"));
    EXPECT_TRUE(warned("averaged of near and far"));
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const bool rim = std::fmod(coverage(x, y, 32, 17.3), 1) > 0;
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(image.pixel(x, y)[c], pinhole.pixel(x, y)[c], rim ? 4e-3F : to) << x << "," << y;
        }
    }
    focus(in("most.exr"), lens);
    EXPECT_FALSE(warned("averaged of near and far"));
}

// In front of an empty background, for any depth that stands for it, a mean depth does not determine the
// depth of the rim.
TEST_F(ForeignKinds, DepthsThatAreMeansWithNothingGetTheirNeighbours) {
    for (const float nothing : {1e10F, 1000.0F, std::numeric_limits<float>::infinity()}) {
        const Plane picture{64,
                            64,
                            [nothing](int x, int y) {
                                const auto share = static_cast<float>(coverage(x, y, 32, 17.3));
                                const float z = share == 1 ? 3 : share * 3 + (1 - share) * nothing;
                                return std::vector<float>{0.9F * share, 0.2F * share, 0.1F * share, share, z};
                            },
                            {"R", "G", "B", "A", "Z"}};
        picture.write(in("mean.exr"));
        for (const std::string& method : both_methods) {
            const Image image =
                focus(in("mean.exr"), {"--f-number", "0.5", "--focus", "3", "--method", method});
            EXPECT_TRUE(warned("averaged with nothing")) << method << nothing;
            EXPECT_LE(difference(image, flattened(in("mean.exr"))), to) << method << " " << nothing;
        }
    }
}

TEST_F(ForeignKinds, EvenVeilsStayEven) {
    constexpr int border = 12;
    for (const std::string& method : both_methods) {
        for (const std::string file : {"slant_half", "bulge_half", "steps"}) {
            for (const char* f_number : {"16", "4", "1", "0.25"}) {
                const Image image = focus(data("translucent/" + file),
                                          {"--focus", "4", "--f-number", f_number, "--method", method});
                const float alpha = file == "steps" ? 1 : 0.5F;
                float most = 0;
                for (int y = border; y < image.height - border; ++y) {
                    for (int x = border; x < image.width - border; ++x) {
                        const std::size_t i =
                            static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                            static_cast<std::size_t>(x);
                        most = std::max({most, std::abs(alpha_at(image, i) - alpha),
                                         std::abs(image.pixel(x, y)[0] - alpha / 2)});
                    }
                }
                EXPECT_LE(most, 2e-6F) << method << " " << file << " f/" << f_number;
            }
        }
    }
}

TEST_F(ForeignKinds, ASmallCropOfALargeFrameOpens) {
    const std::string path = data("large_frame/crop");
    EXPECT_EQ(done({"info", path}).at("width"), 4000);
    done({"image", path, "-o", in("i.exr"), "--crop", "1800,2500,96,96"});
    const ForeignPicture pinhole = read_foreign_picture(in("i.exr"), {}, {});
    // Focusing takes time for every pixel of the frame, so the frame ends close behind the crop.
    std::string bytes = bytes_of(path);
    constexpr std::string_view name("displayWindow\0box2i\0\x10\0\0", 24);
    const std::size_t at = bytes.find(name);
    ASSERT_NE(at, std::string::npos);
    constexpr std::array<std::int32_t, 4> window{0, 0, 1899, 2599};
    std::memcpy(bytes.data() + at + name.size(), window.data(), sizeof(window));
    std::ofstream(in("frame.exr"), std::ios::binary) << bytes;
    for (const std::string& method : both_methods) {
        const Outcome r = run({"focus",
                               in("frame.exr"),
                               "-o",
                               in("o.exr"),
                               "--focal-length",
                               "50",
                               "--film-width",
                               "36",
                               "--metres-per-unit",
                               "1",
                               "--z",
                               "axial",
                               "--f-number",
                               "2.8",
                               "--focus",
                               "6",
                               "--crop",
                               "1800,2500,96,96",
                               "--method",
                               method});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const ForeignPicture made = read_foreign_picture(in("o.exr"), {}, {});
        for (int y = 2520; y < 2576; ++y) {
            for (int x = 1872; x < 1886; ++x) {
                ASSERT_EQ(made.stack(x, y).size(), 1U);
                EXPECT_NEAR(made.stack(x, y)[0].r, pinhole.stack(x, y)[0].r, to) << x << "," << y;
            }
        }
    }
}

TEST_F(ForeignKinds, CropsAreInvisible) {
    for (const std::string& method : both_methods) {
        const Words lens{"--f-number", "0.5", "--focus", "2.5", "--method", method};
        const Image one = focus(data("windows/one"), lens);
        for (const std::string file : {"same", "depth_tighter", "depth_looser", "depth_partly"})
            EXPECT_LE(difference(focus(data("windows/" + file), lens), one), to) << method << " " << file;
        for (const char* metres : {"1", "6"}) {
            const Words wide{"--f-number", "0.12", "--focus", metres, "--method", method};
            const Image whole = focus(data("windows/uncropped"), wide),
                        cropped = focus(data("windows/autocrop"), wide);
            EXPECT_LE(difference(cropped, whole), to) << method << " " << metres;
            double sum = 0;
            for (const float a : cropped.alpha) sum += static_cast<double>(a);
            EXPECT_NEAR(sum, 432, 0.01) << method << " " << metres;
        }
    }
}

TEST_F(ForeignKinds, PassesMayHaveFilesOfTheirOwn) {
    const auto value = [](const std::string& channel, int x, int y) -> float {
        const bool near = x > 20 && x < 44 && y > 10;
        if (channel == "R") return near ? 0.8F : 0.1F;
        if (channel == "G") return 0.1F * static_cast<float>(y % 5);
        if (channel == "B") return near ? 0.2F : 0.7F;
        if (channel == "Z") return near ? 2 : 9;
        if (channel == "id") return near ? 3 : 4;
        return channel == "forward.u" && near ? 6 : 0;
    };
    const auto write = [&](const std::string& name, const std::vector<std::string>& channels) {
        Plane{64, 40,
              [&](int x, int y) {
                  std::vector<float> out;
                  for (const std::string& c : channels) out.push_back(value(c, x, y));
                  return out;
              },
              channels}
            .write(in(name));
    };
    write("all.exr", {"R", "G", "B", "Z", "id", "forward.u", "forward.v"});
    write("colours.exr", {"R", "G", "B"});
    write("depth.exr", {"Z"});
    write("ids.exr", {"id"});
    write("vectors.exr", {"forward.u", "forward.v"});
    const Words files{"--depth-file", in("depth.exr"), "--ids-file", in("ids.exr")};
    Words lens{"--f-number", "0.5", "--focus", "2", "--method", "layers"};
    const Image wanted = focus(in("all.exr"), lens);
    EXPECT_EQ(said_.at("channels").at("id"), "id");
    lens.insert(lens.end(), files.begin(), files.end());
    EXPECT_EQ(difference(focus(in("colours.exr"), lens), wanted), 0);
    EXPECT_EQ(said_.at("channels").at("depth"), "Z");
    EXPECT_EQ(said_.at("channels").at("id"), "id");

    done({"motionblur", in("all.exr"), "-o", in("m.exr"), "--shutter", "0:1"});
    Words blur{"motionblur",     in("colours.exr"), "-o", in("n.exr"), "--shutter", "0:1",
               "--vectors-file", in("vectors.exr")};
    blur.insert(blur.end(), files.begin(), files.end());
    done(blur);
    EXPECT_EQ(difference(read_image(in("n.exr")), read_image(in("m.exr"))), 0);

    // Depth files of another size, and files without depths, are rejected.
    Plane{32, 40, [](int, int) { return std::vector<float>{1}; }, {"Z"}}.write(in("narrow.exr"));
    for (const auto& [file, words] : {std::pair("narrow.exr", "displayWindow differs"),
                                      {"vectors.exr", "no depth (got channels forward.u"},
                                      {"none.exr", "none.exr: cannot read (no such file)"}}) {
        const Outcome r = run({"focus", in("colours.exr"), "-o", in("o.exr"), "--f-number", "1", "--focus",
                               "2", "--depth-file", in(file)});
        EXPECT_NE(r.exit_code, 0) << file;
        EXPECT_NE(r.err.find(words), std::string::npos) << r.err;
    }
    // In a sequence, each frame has its own depth file.
    std::filesystem::copy(in("colours.exr"), in("c.0007.exr"));
    std::filesystem::copy(in("depth.exr"), in("d.0007.exr"));
    done({"focus", in("c.####.exr"), "-o", in("f.####.exr"), "--frames", "7", "--f-number", "0.5", "--focus",
          "2", "--depth-file", in("d.####.exr")});
    EXPECT_TRUE(std::filesystem::exists(in("f.0007.exr")));
    EXPECT_EQ(run({"focus", in("c.####.exr"), "-o", in("f.####.exr"), "--frames", "7", "--f-number", "0.5",
                   "--focus", "2", "--depth-file", in("depth.exr")})
                  .exit_code,
              2);
}

// The displacement is (value - offset) scale.
TEST_F(ForeignKinds, VectorsMayHaveAnOffsetAndAScale) {
    const auto picture = [](float offset, float scale) {
        return Plane{64,
                     32,
                     [=](int x, int y) {
                         const bool moves = x > 20 && x < 40 && y > 8 && y < 24;
                         const float u = moves ? 8 : 0, v = moves ? -4 : 0;
                         return std::vector<float>{
                             moves ? 0.9F : 0.1F, 0.5F, 0.2F, moves ? 2.0F : 5.0F, offset + u / scale,
                             offset + v / scale};
                     },
                     {"R", "G", "B", "Z", "motion.x", "motion.y"}};
    };
    picture(0, 1).write(in("px.exr"));
    picture(0.5F, 32).write(in("coded.exr"));
    const auto blurred = [&](const Words& more) {
        Words words{"motionblur", "", "-o", in("o.exr"), "--shutter", "0:1"};
        words.insert(words.end(), more.begin(), more.end());
        words[1] = more.empty() ? in("px.exr") : in("coded.exr");
        said_ = done(words);
        return read_image(in("o.exr"));
    };
    const Image wanted = blurred({});
    EXPECT_FALSE(warned("--vector-offset"));
    EXPECT_EQ(difference(blurred({"--vector-offset", "0.5", "--vector-scale", "32"}), wanted), 0);
    EXPECT_FALSE(warned("--vector-offset"));
    (void)blurred({"--vector-scale", "32"});
    EXPECT_TRUE(warned("--vector-offset"));
}

}  // namespace
}  // namespace postlens::test::foreign_kinds_test
