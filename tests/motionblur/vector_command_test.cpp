// Motion blur of flat images by the command, and of a published picture.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/stat.h>
#include <vector>

#include "motionblur/vectors/vector_blur.h"
#include "motionblur/vectors/vector_frame.h"
#include "tests/motionblur/flat_pictures.h"
#include "tests/support/command_test.h"

namespace postlens::test::vector_command_test {
namespace {

namespace fs = std::filesystem;

TEST_F(VectorFrameTest, CommandBlursAndReports) {
    plate().write(in("plate.exr"));
    const Outcome r = run({"motionblur", in("plate.exr"), "-o", in("out.exr"), "--shutter", "0:1", "--json"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_EQ(json["method"], "lightfield");
    EXPECT_EQ(json["views"], 131);
    EXPECT_EQ(json["instants"], 1);
    EXPECT_TRUE(json["objects"].empty());
    ASSERT_EQ(json["warnings"].size(), 1U);
    EXPECT_EQ(json["warnings"][0]["code"], "uncovered");
    const Image image = read_image(in("out.exr"));
    const Image expected = vector_blur(read_vector_frame(in("plate.exr"), {}), {.exposure = {0, 1}}).image;
    EXPECT_EQ(image.rgb, expected.rgb);
    // The user's scale reverses the motion.
    ASSERT_EQ(run({"motionblur", in("plate.exr"), "-o", in("back.exr"), "--shutter", "1:1", "--vectors",
                   "forward.u,forward.v", "--vectors-scale", "-1,1"})
                  .exit_code,
              0);
    EXPECT_EQ(read_image(in("back.exr")).pixel(plate_x - 12, plate_y - 5)[0], plate_colour);
    EXPECT_EQ(run({"motionblur", in("plate.exr"), "-o", in("strict.exr"), "--shutter", "0:1", "--strict"})
                  .exit_code,
              6);
}

TEST_F(VectorFrameTest, CommandRefusesInOneLine) {
    plate().write(in("plate.exr"));
    const std::string plate_file = in("plate.exr"), out = in("out.png");
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"motionblur", plate_file, "-o", out};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    refused(with({}), ExitCode::wrong_arguments, "--shutter: missing");
    refused(with({"--shutter", "1:0"}), ExitCode::wrong_arguments, "--shutter: closes before it opens");
    refused(with({"--shutter", "0:1e9"}), ExitCode::wrong_arguments, "--shutter: out of range");
    refused(with({"--shutter", "0:1", "--method", "convolve"}), ExitCode::wrong_arguments,
            "--method convolve");
    refused(with({"--shutter", "0:1", "--paths", "p.toml"}), ExitCode::wrong_arguments, "--paths");
    refused(with({"--shutter", "0:1", "--fit-paths", "1"}), ExitCode::wrong_arguments, "--fit-paths");
    for (const char* option :
         {"--scene", "--explain", "--target-db", "--metres-per-unit", "--lumens-per-watt"})
        refused(with({"--shutter", "0:1", option, "40"}), ExitCode::wrong_arguments, option);
    refused(with({"--shutter", "0:1", "--views", "0"}), ExitCode::wrong_arguments, "--views");
    refused(with({"--shutter", "0:1", "--vectors", "u"}), ExitCode::wrong_arguments, "--vectors");
    refused(with({"--shutter", "0:1", "--vector-scale", "x"}), ExitCode::wrong_arguments, "--vector-scale");
    refused(with({"--shutter", "0:1", "--vectors", "a,b"}), ExitCode::invalid_input, "no channel a");
    // A folder, a missing file, and a file without permission.
    fs::create_directory(in("folder.exr"));
    refused({"motionblur", in("folder.exr"), "-o", out, "--shutter", "0:1"}, ExitCode::invalid_input,
            "folder.exr");
    refused({"motionblur", in("none.exr"), "-o", out, "--shutter", "0:1"}, ExitCode::invalid_input,
            "none.exr");
    if (::geteuid() != 0) {  // root reads everything
        ::chmod(plate_file.c_str(), 0);
        refused(with({"--shutter", "0:1"}), ExitCode::invalid_input, "plate.exr");
        ::chmod(plate_file.c_str(), S_IRUSR | S_IWUSR);
    }
}

TEST_F(VectorFrameTest, CommandRefusesDamagedFiles) {
    plate().write(in("plate.exr"));
    const std::string bytes = bytes_of(in("plate.exr"));
    const auto refused_with = [&](const std::string& name, const std::string& content) {
        std::ofstream(in(name), std::ios::binary) << content;
        refused({"motionblur", in(name), "-o", in("out.png"), "--shutter", "0:1"}, ExitCode::invalid_input,
                name);
    };
    refused_with("half.exr", bytes.substr(0, bytes.size() / 2));
    refused_with("last.exr", bytes.substr(0, bytes.size() - 9));
    refused_with("header.exr", bytes.substr(0, 60));
    refused_with("magic.exr", bytes.substr(0, 4));
    // A data window of 2^31 px: four little-endian integers after the attribute's name, type and length.
    std::string absurd = bytes;
    const std::size_t at = absurd.find("dataWindow");
    ASSERT_NE(at, std::string::npos);
    const std::size_t x_max = at + sizeof("dataWindow") + sizeof("box2i") + 4 + 8;
    absurd.replace(x_max, 4, std::string("\xff\xff\xff\x7f", 4));
    refused_with("absurd.exr", absurd);
    absurd.replace(x_max, 8, std::string("\xff\xff\x00\x00\xff\xff\x00\x00", 8));  // 65536 x 65536
    refused_with("large.exr", absurd);
}

class Beachball : public VectorFrameTest {
  protected:
    static std::string frame(int number) {
        return std::string(POSTLENS_SHARED_DATA) + "/exr-flat/Beachball_singlepart.000" +
               std::to_string(number) + ".exr";
    }
    void SetUp() override {
        if (!fs::exists(frame(1)) || !fs::exists(frame(2)))
            GTEST_SKIP() << "no " << frame(1) << " and .0002: the beach ball is not tested";
    }
    // RMS error around the ball, in the region that both frames show.
    static double rmse(const Image& a, const Image& b) {
        double sum = 0;
        std::size_t count = 0;
        for (int y = 200; y < 1300; ++y) {
            for (int x = 600; x < 1700; ++x) {
                for (int c = 0; c < 3; ++c, ++count) {
                    const double d =
                        static_cast<double>(a.pixel(x, y)[c]) - static_cast<double>(b.pixel(x, y)[c]);
                    sum += d * d;
                }
            }
        }
        return std::sqrt(sum / static_cast<double>(count));
    }
    static Image moved(const VectorFrame& frame) {
        return vector_blur(frame, {.exposure = {1, 1}, .views = 4}).image;
    }
    static Image moved(glm::dvec2 scale) { return moved(read_vector_frame(frame(1), {.scale = scale})); }
};

TEST_F(Beachball, MovesToTheRightAndDownAsTheNextFrameShows) {
    const Image first = read_image(frame(1)), second = read_image(frame(2));
    const VectorFrame f = read_vector_frame(frame(1), {});
    EXPECT_EQ(f.u_name, "forward.right.u");  // the colours are those of the right view
    EXPECT_TRUE(f.has_z && f.has_alpha);
    EXPECT_GT(f.at(1000, 683).right_px, 40);
    EXPECT_GT(f.at(1000, 683).down_px, 40);
    // The vectors are for an exposure of about 0.4 frames (docs/motion_vectors.md), so they move the ball by
    // 0.4 of its motion to the next frame. An error proportional to the distance would decrease to 0.6 of
    // that without motion; edges that no longer overlap make it slightly larger. 2.43 and 2.75 times the
    // vectors are the whole motion.
    const double unmoved = rmse(first, second), by_names = rmse(moved(f), second),
                 downwards = rmse(moved(glm::dvec2(1, 1)), second),
                 whole_way = rmse(moved(glm::dvec2(2.43, -2.75)), second);
    fmt::print("rmse to frame 2: unmoved {:.4f}, by the vectors {:.4f}, v downwards {:.4f}, scaled {:.4f}\n",
               unmoved, by_names, downwards, whole_way);
    EXPECT_GT(unmoved, 0.1);  // the frames differ clearly
    EXPECT_LT(by_names, 0.9 * unmoved);
    EXPECT_LT(by_names, 0.9 * downwards);
    EXPECT_LT(whole_way, 0.5 * by_names);
}

TEST_F(Beachball, BlursWithinTheWayAndKeepsTheRest) {
    const VectorFrame f = read_vector_frame(frame(1), {});
    const Image still = f.picture(), blurred = vector_blur(f, {.exposure = {0, 1}, .views = 16}).image;
    // The centroid of the light moves by half of the vectors, weighted by light. No light is lost in the
    // black surroundings.
    const auto centre = [](const Image& image) {
        glm::dvec3 sum(0);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const float* p = image.pixel(x, y);
                const double v =
                    static_cast<double>(p[0]) + static_cast<double>(p[1]) + static_cast<double>(p[2]);
                sum += v * glm::dvec3(x, y, 1);
            }
        }
        return sum;
    };
    glm::dvec2 way(0);
    double light = 0;
    for (int y = f.y_begin; y < f.y_end; ++y) {
        for (int x = f.x_begin; x < f.x_end; ++x) {
            const VectorPixel& p = f.at(x, y);
            const double v =
                static_cast<double>(p.rgb[0]) + static_cast<double>(p.rgb[1]) + static_cast<double>(p.rgb[2]);
            way += v * glm::dvec2(p.right_px, p.down_px);
            light += v;
        }
    }
    const glm::dvec3 before = centre(still), after = centre(blurred);
    const glm::dvec2 shift = glm::dvec2(after) / after.z - glm::dvec2(before) / before.z;
    // The vectors differ by 4 px between the ball's front and its rim, so its area may change by 4 px of its
    // radius of 430 px, 1 %. This moves the centroid by at most 1 % of the radius.
    EXPECT_NEAR(after.z / before.z, 1, 0.01);
    EXPECT_NEAR(shift.x, 0.5 * way.x / light, 4.3);
    EXPECT_NEAR(shift.y, 0.5 * way.y / light, 4.3);
    EXPECT_GT(shift.x, 15);
    EXPECT_GT(shift.y, 15);
    fmt::print("centre of light moved by {:.2f}, {:.2f} px; half the vectors {:.2f}, {:.2f}\n", shift.x,
               shift.y, 0.5 * way.x / light, 0.5 * way.y / light);
}

}  // namespace
}  // namespace postlens::test::vector_command_test
