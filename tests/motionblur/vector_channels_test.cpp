// Flat images with motion vectors: which channels are read, windows and refusals.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "motionblur/vectors/vector_blur.h"
#include "motionblur/vectors/vector_frame.h"
#include "tests/motionblur/flat_pictures.h"
#include "tests/support/refusal.h"

namespace postlens::test::vector_channels_test {
namespace {

TEST_F(VectorFrameTest, ScaleAndSignAreWhatTheNamesOrTheUserSay) {
    const auto vector_of = [&](const std::string& u, const std::string& v, const VectorChoice& choice) {
        FlatPicture p = plate();
        p.channels[4] = u;
        p.channels[5] = v;
        const VectorPixel pixel = frame_of(p, choice).at(plate_x, plate_y);
        return glm::vec2(pixel.right_px, pixel.down_px);
    };
    EXPECT_EQ(vector_of("forward.u", "forward.v", {}), glm::vec2(12, 5));
    EXPECT_EQ(vector_of("forward.left.u", "forward.left.v", {}), glm::vec2(12, 5));
    EXPECT_EQ(vector_of("ViewLayer.Vector.Z", "ViewLayer.Vector.W", {}), glm::vec2(-12, -5));
    EXPECT_EQ(vector_of("Vector.Z", "Vector.W", {}), glm::vec2(-12, -5));
    EXPECT_EQ(vector_of("motion.x", "motion.y", {}), glm::vec2(12, -5));
    EXPECT_EQ(vector_of("velocity.x", "velocity.y", {}), glm::vec2(12, -5));
    EXPECT_EQ(vector_of("velocity.X", "velocity.Y", {}), glm::vec2(12, -5));
    EXPECT_EQ(vector_of("motionVectors.R", "motionVectors.G", {}), glm::vec2(12, -5));
    EXPECT_EQ(vector_of("VRayVelocity.u", "VRayVelocity.v", {.scale = glm::dvec2(2, -1)}), glm::vec2(24, 5));
    EXPECT_EQ(vector_of("forward.u", "forward.v", {.scale = glm::dvec2(0.5, 2)}), glm::vec2(6, -10));
    EXPECT_EQ(vector_of("a", "b", {.channels = {{"a", "b"}}}), glm::vec2(12, -5));
    EXPECT_EQ(vector_of("a", "b", {.channels = {{"a", "b"}}, .scale = glm::dvec2(-1, -2)}),
              glm::vec2(-12, 10));
    EXPECT_EQ(vector_of("forward.u", "forward.v", {.channels = {{"forward.v", "forward.u"}}}),
              glm::vec2(-5, 12));
}

TEST_F(VectorFrameTest, PassesOfALayerBelongTogether) {
    FlatPicture p;
    p.channels = {"Low.Combined.R", "Low.Combined.G", "Low.Combined.B", "Low.Depth.V",
                  "Top.Combined.R", "Top.Combined.G", "Top.Combined.B", "Top.Depth.V",
                  "Top.Vector.X",   "Top.Vector.Y",   "Top.Vector.Z",   "Top.Vector.W"};
    p.values = [](int, int) { return std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}; };
    // The layer Low has no vectors, and those of Top do not belong to it.
    const VectorFrame frame = frame_of(p);
    EXPECT_EQ(frame.u_name, "Top.Vector.Z");
    EXPECT_EQ(frame.v_name, "Top.Vector.W");
    EXPECT_EQ(frame.at(3, 3).rgb[0], 5);
    EXPECT_EQ(frame.at(3, 3).inverse_z, 1.0F / 8);
    expect_refused([&] { (void)read_vector_frame(in("flat.exr"), {}, {.layer = "Low"}); },
                   ExitCode::invalid_input, "no motion vectors of the colours' own layer");
}

// In a stereo file, channels without a view's name belong to the hero view, for colours and vectors.
TEST_F(VectorFrameTest, VectorsAreThoseOfTheColoursView) {
    for (const std::string hero : {"right", "left"}) {
        const std::string other = hero == "right" ? "left" : "right";
        Imf::Header h(2, 2);
        Imf::addMultiView(h, {hero, other});
        const std::vector<std::string> names{"R",
                                             "G",
                                             "B",
                                             other + ".R",
                                             other + ".G",
                                             other + ".B",
                                             "forward.left.u",
                                             "forward.left.v",
                                             "forward.right.u",
                                             "forward.right.v"};
        std::vector<float> zeros(4, 0.0F);
        Imf::FrameBuffer pixels;
        for (const std::string& n : names) {
            h.channels().insert(n, Imf::Channel(Imf::FLOAT));
            pixels.insert(n, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(zeros.data()), 4, 8));
        }
        {
            Imf::OutputFile out(in("stereo.exr").c_str(), h);
            out.setFrameBuffer(pixels);
            out.writePixels(2);
        }
        EXPECT_EQ(read_vector_frame(in("stereo.exr"), {}).u_name, "forward." + hero + ".u");
        EXPECT_EQ(read_vector_frame(in("stereo.exr"), {}, {.layer = other}).u_name,
                  "forward." + other + ".u");
    }
}

TEST_F(VectorFrameTest, WindowsMayDiffer) {
    // The display window begins at (100, 50). The file stores only the plate, and a pixel left of the display
    // window that moves into it.
    FlatPicture p;
    p.display = {100, 50, 64, 48};
    p.data = {97, 60, 20, 10};
    p.values = [](int x, int) {
        return x == 97 ? std::vector<float>{0.5F, 0, 0, 2, 8, 0} : std::vector<float>{0.25F, 0, 0, 4, 0, 0};
    };
    const VectorFrame f = frame_of(p);
    EXPECT_EQ(f.width, 64);
    EXPECT_EQ(f.x_begin, -3);
    EXPECT_EQ(f.y_begin, 10);
    const MotionBlurResult r = vector_blur(f, {.exposure = {1, 1}});
    EXPECT_EQ(r.image.width, 64);
    EXPECT_EQ(r.image.height, 48);
    EXPECT_EQ(r.image.pixel(5, 12)[0], 0.5F);
    EXPECT_EQ(r.image.pixel(6, 12)[0], 0.25F);
    EXPECT_EQ(r.image.pixel(40, 40)[0], 0);
}

TEST_F(VectorFrameTest, RefusesPixelsThatAreNoNumbersWithTheirPlace) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const auto& [channel, value] : std::vector<std::pair<std::size_t, float>>{
             {0, nan}, {2, inf}, {3, nan}, {3, -1.0F}, {3, -inf}, {4, nan}, {5, -inf}, {4, 3e6F}}) {
        FlatPicture p = plate();
        const auto usual = p.values;
        p.values = [usual, at = channel, bad = value](int x, int y) {
            std::vector<float> v = usual(x, y);
            if (x == 41 && y == 7) v[at] = bad;
            return v;
        };
        const std::string said = refusal(p);
        EXPECT_NE(said.find("channel " + p.channels[channel] + " at pixel 41,7"), std::string::npos)
            << said << " for " << value;
    }
}

TEST_F(VectorFrameTest, RefusesMissingChannelsAndNamesThoseThereAre) {
    FlatPicture p = plate();
    p.channels[4] = "speed.x";
    EXPECT_NE(refusal(p).find("no motion vectors (got channels B, G, R, Z, "), std::string::npos)
        << refusal(p);
    p = plate();
    p.channels[0] = "red";
    EXPECT_NE(refusal(p).find("no colours"), std::string::npos) << refusal(p);
}

TEST_F(VectorFrameTest, RefusesWindowsOutOfBounds) {
    FlatPicture p = plate();
    p.display = {0, 0, 70000, 48};
    EXPECT_NE(refusal(p).find("out of bounds"), std::string::npos) << refusal(p);
    p = plate();
    p.data = {100000, 0, 64, 48};
    EXPECT_NE(refusal(p).find("out of bounds"), std::string::npos) << refusal(p);
    p = plate();
    p.display = {0, 0, 60000, 60000};
    EXPECT_NE(refusal(p).find("out of bounds"), std::string::npos) << refusal(p);
}

}  // namespace
}  // namespace postlens::test::vector_channels_test
