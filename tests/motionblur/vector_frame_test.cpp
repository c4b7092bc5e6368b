// Motion blur of flat images by their motion vectors.
#include "motionblur/vectors/vector_frame.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "core/threads.h"
#include "motionblur/vectors/vector_blur.h"
#include "motionblur/vectors/vector_sheets.h"
#include "tests/support/command_test.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using test::CommandTest;
using test::Outcome;

struct Window {
    int x = 0, y = 0, width = 64, height = 48;
};

/// Writes a flat OpenEXR image; `values` returns the channels of a pixel by its position in the file.
struct FlatPicture {
    std::vector<std::string> channels{"R", "G", "B", "Z", "forward.u", "forward.v"};
    Window data, display;
    std::function<std::vector<float>(int x, int y)> values;

    void write(const std::string& path) const {
        OIIO::ImageSpec spec(data.width, data.height, static_cast<int>(channels.size()),
                             OIIO::TypeDesc::FLOAT);
        spec.x = data.x;
        spec.y = data.y;
        spec.full_x = display.x;
        spec.full_y = display.y;
        spec.full_width = display.width;
        spec.full_height = display.height;
        spec.channelnames = channels;
        std::vector<float> all;
        for (int y = data.y; y < data.y + data.height; ++y) {
            for (int x = data.x; x < data.x + data.width; ++x) {
                const std::vector<float> v = values(x, y);
                all.insert(all.end(), v.begin(), v.end());
            }
        }
        const auto out = OIIO::ImageOutput::create(path);
        ASSERT_TRUE(out && out->open(path, spec) && out->write_image(OIIO::TypeDesc::FLOAT, all.data()) &&
                    out->close())
            << OIIO::geterror();
    }
};

constexpr int plate_x = 12, plate_y = 14, plate_width = 30, plate_height = 20;
constexpr float plate_colour = 0.75F, ground_colour = 0.25F;

bool in_plate(int x, int y) {
    return x >= plate_x && x < plate_x + plate_width && y >= plate_y && y < plate_y + plate_height;
}

/// A plate at depth 2 that moves by (12, 5) px, with v upwards, over a ground at depth 5.
FlatPicture plate() {
    FlatPicture p;
    p.values = [](int x, int y) {
        return in_plate(x, y) ? std::vector<float>{plate_colour, 0.5F, 0, 2, 12, -5}
                              : std::vector<float>{ground_colour, 0.5F, 1, 5, 0, 0};
    };
    return p;
}

double ramp_mean(double a, double b) {  // of clamp(s, 0, 1) for s in [a, b]
    const auto integral = [](double s) { return s <= 0 ? 0 : s >= 1 ? s - 0.5 : 0.5 * s * s; };
    return (integral(b) - integral(a)) / (b - a);
}

/// The share of the light of pixel [x, x + 1) that comes from a bar [x0, x1), which moves by d > 0 while the
/// shutter is open. The part of the pixel right of an edge at e is clamp(x + 1 - e, 0, 1).
double bar_share(double x, double x0, double x1, double d) {
    return ramp_mean(x + 1 - x0 - d, x + 1 - x0) - ramp_mean(x + 1 - x1 - d, x + 1 - x1);
}

class VectorFrameTest : public CommandTest {
  protected:
    VectorFrame frame_of(const FlatPicture& picture, const VectorChoice& vectors = {},
                         const ForeignChoice& choice = {}) {
        const std::string path = in("flat.exr");
        picture.write(path);
        return read_vector_frame(path, vectors, choice);
    }
    // The error message for an image; empty if there is none.
    std::string refusal(const FlatPicture& picture, ExitCode code = ExitCode::invalid_input) {
        try {
            (void)frame_of(picture);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), code) << e.what();
            return e.what();
        }
        return "";
    }
};

TEST_F(VectorFrameTest, IdsPartAndJoinSurfaces) {
    // With depths that differ by 0.5 % and vectors that differ by one pixel, pixels are one surface, but ids
    // can separate them. Where the depth jumps, equal ids connect them.
    const auto two = [](std::uint32_t id, std::uint32_t other, float z) {
        return std::pair(VectorPixel{{}, 1, 10, 0, id}, VectorPixel{{}, 1 / z, 11, 0, other});
    };
    for (const auto& [id, other, z, joined] :
         {std::tuple(0U, 0U, 1.005F, true), std::tuple(3U, 4U, 1.005F, false),
          std::tuple(3U, 3U, 1.005F, true), std::tuple(3U, 0U, 1.005F, true), std::tuple(0U, 0U, 2.0F, false),
          std::tuple(3U, 3U, 2.0F, true), std::tuple(3U, 0U, 2.0F, false)}) {
        const auto [a, b] = two(id, other, z);
        EXPECT_EQ(one_surface(a, b, true), joined) << id << " " << other << " " << static_cast<double>(z);
    }
    // Pixels with similar motion stay connected for any ids; pixels with very different motion are separated.
    EXPECT_TRUE(one_surface({{}, 1, 10, 0, 3}, {{}, 1, 10.2F, 0, 4}, true));
    EXPECT_FALSE(one_surface({{}, 1, 10, 0, 3}, {{}, 1, 20, 0, 3}, true));
}

TEST_F(VectorFrameTest, TilesOfOneDepthPartByTheirIds) {
    // Two tiles side by side at one depth, one of which is 1.5 px faster. By depth alone, the seam between
    // them would move with the mean of both.
    FlatPicture tiles;
    tiles.channels = {"R", "G", "B", "Z", "forward.u", "forward.v", "objectId"};
    const auto seam_px = [&](float id) {
        tiles.values = [id](int x, int) {
            return x < 32 ? std::vector<float>{1, 0, 0, 2, 6, 0, 7}
                          : std::vector<float>{0, 1, 0, 2, 7.5F, 0, id};
        };
        const VectorFrame frame = frame_of(tiles);
        EXPECT_EQ(frame.id_name, "objectId");
        const SheetMesh mesh = vector_sheets(frame);
        std::vector<float> speeds;  // of the pixels at the seam, at their common side
        for (const Sheet& s : mesh.sheets) {
            for (int k = 0; k < s.width * s.height; ++k) {
                const int x = s.x + k % s.width;
                if (x != 31 && x != 32) continue;
                const CellPlane& w =
                    mesh.planes[mesh.values * (s.first_cell + static_cast<std::size_t>(k)) + 1];
                speeds.push_back(-(w.value + (x == 31 ? 0.5F : -0.5F) * w.x));
            }
        }
        const auto [least, most] = std::minmax_element(speeds.begin(), speeds.end());
        return std::pair(*least, *most);
    };
    EXPECT_EQ(seam_px(7), std::pair(6.75F, 6.75F));
    EXPECT_EQ(seam_px(8), std::pair(6.0F, 7.5F));
    EXPECT_EQ(frame_of(tiles, {}, {.ids = "none"}).id_name, "");
    EXPECT_EQ(frame_of(tiles, {}, {.ids = "none"}).at(40, 3).id, 0U);
    EXPECT_EQ(refusal(tiles), "");
    tiles.channels.back() = "CryptoObject00.R";  // without its coverage
    EXPECT_EQ(frame_of(tiles).id_name, "");
}

TEST_F(VectorFrameTest, PlateInMotionIsATrapezoid) {
    constexpr int views = 4096;
    const MotionBlurResult r = vector_blur(frame_of(plate()), {.exposure = {0, 1}, .views = views});
    // The points (position across the edge, instant) form a (0, 12)-net with positions of 6 bits: each box of
    // 2^-k by 2^-(12-k) holds one point. The error of a straight edge is at most the number of boxes that it
    // crosses, 2^k + 2^(12-k)/d + 1 for a motion of d px: 38 of 4096 (k = 4, d = 12) and 59 (k = 5, d = 5).
    constexpr double contrast = static_cast<double>(plate_colour - ground_colour);
    const auto expect = [&](int x, int y, double share, double tolerance) {
        EXPECT_NEAR(static_cast<double>(r.image.pixel(x, y)[0]),
                    static_cast<double>(ground_colour) + contrast * share, contrast * tolerance + 1e-6)
            << x << "," << y;
    };
    // Tests rows, then columns, that the plate covers during the whole exposure.
    double largest = 0, smallest = 1;
    for (int x = 0; x < 64; ++x) {
        const double share = bar_share(x, plate_x, plate_x + plate_width, 12);
        largest = std::max(largest, share);
        smallest = std::min(smallest, share);
        for (int y = plate_y + 5; y < plate_y + plate_height; ++y) expect(x, y, share, 38.0 / views);
    }
    EXPECT_EQ(largest, 1);  // the tested rows include the plateau and the ground
    EXPECT_EQ(smallest, 0);
    for (int y = 0; y < 48; ++y) {
        const double share = bar_share(y, plate_y, plate_y + plate_height, 5);
        for (int x = plate_x + 12; x < plate_x + plate_width; ++x) expect(x, y, share, 59.0 / views);
    }
    // Pixels that always show the plate, or always the ground, are exact for any number of views.
    EXPECT_EQ(r.image.pixel(30, 25)[0], plate_colour);
    EXPECT_EQ(r.image.pixel(2, 2)[0], ground_colour);
    // Nothing is known behind the plate, so the pixels that it leaves are holes.
    ASSERT_EQ(r.warnings.size(), 1U);
    EXPECT_EQ(r.warnings[0].code, "uncovered");
    const double left = plate_width * plate_height - (plate_width - 12) * (plate_height - 5);
    EXPECT_NEAR(r.warnings[0].share, left / (64 * 48), 1e-9);
}

TEST_F(VectorFrameTest, WholePixelsMoveWithTheirBits) {
    FlatPicture p = plate();
    const auto still = p.values;
    p.values = [still](int x, int y) {
        std::vector<float> v = still(x, y);
        if (in_plate(x, y)) v[1] = static_cast<float>((x * 31 + y * 17) % 23) / 23;
        return v;
    };
    const MotionBlurResult r = vector_blur(frame_of(p), {.exposure = {1, 1}});
    for (int y = 0; y < plate_height; ++y) {
        for (int x = 0; x < plate_width; ++x) {
            const float* got = r.image.pixel(plate_x + 12 + x, plate_y + 5 + y);
            EXPECT_EQ(got[0], plate_colour);
            EXPECT_EQ(got[1], p.values(plate_x + x, plate_y + y)[1]) << x << "," << y;
        }
    }
    EXPECT_EQ(r.image.pixel(plate_x, plate_y)[0], ground_colour);
}

TEST_F(VectorFrameTest, ZeroVectorsAndZeroExposureAreThePictureBitForBit) {
    FlatPicture p;
    p.channels.emplace_back("A");
    float u = 0;
    p.values = [&u](int x, int y) {
        return std::vector<float>{std::sin(static_cast<float>(x * 7 + y)),
                                  static_cast<float>(y) * 0.1F,
                                  1e-3F,
                                  static_cast<float>(1 + x % 5),
                                  u,
                                  0,
                                  1};
    };
    const VectorFrame still = frame_of(p);
    u = 3;
    const VectorFrame moving = frame_of(p);
    for (const auto& [frame, exposure] :
         {std::pair{&still, Exposure{0, 1}}, {&still, Exposure{-2, 7}}, {&moving, Exposure{0, 0}}}) {
        const MotionBlurResult r = vector_blur(*frame, {.exposure = exposure});
        EXPECT_TRUE(r.warnings.empty());
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_EQ(r.image.pixel(x, y)[c], p.values(x, y)[c]) << x << "," << y;
            }
        }
    }
    EXPECT_NE(vector_blur(moving, {.exposure = {0, 1}}).image.rgb, still.picture().rgb);
}

TEST_F(VectorFrameTest, StillPixelsBesideWhatMovesKeepTheirBits) {
    FlatPicture p = plate();
    const auto uniform = p.values;
    p.values = [uniform](int x, int y) {
        std::vector<float> v = uniform(x, y);
        if (!in_plate(x, y)) v[1] = static_cast<float>((x * 31 + y * 17) % 23) / 23;
        return v;
    };
    const MotionBlurResult r = vector_blur(frame_of(p), {.exposure = {0, 1}});
    EXPECT_GT(r.touched_share, 0.1);
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            const bool reached = x >= plate_x && x < plate_x + plate_width + 12 && y >= plate_y &&
                                 y < plate_y + plate_height + 5;
            if (reached) continue;
            ASSERT_EQ(r.image.pixel(x, y)[1], p.values(x, y)[1]) << x << "," << y;
        }
    }
}

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
    try {
        (void)read_vector_frame(in("flat.exr"), {}, {.layer = "Low"});
        FAIL() << "taken";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("no motion vectors of the colours' own layer"),
                  std::string::npos)
            << e.what();
    }
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

TEST_F(VectorFrameTest, RotationFieldTurnsThePictureWithoutCracks) {
    // The vectors are w x (x - c), and colours are linear in x and y. At t the vertices are at c + (1 + t
    // J)(x - c): a rotation by atan(w t) and a scale of sqrt(1 + w^2 t^2). The colour at a position is that
    // of its origin.
    constexpr double w = 0.4, cx = 32, cy = 24;
    FlatPicture p;
    const auto ramp = [](double x, double y, double* rgb) {
        rgb[0] = 0.01 * x;
        rgb[1] = 0.01 * y;
    };
    p.values = [&](int x, int y) {
        double rgb[2];
        ramp(x + 0.5, y + 0.5, rgb);
        const double dx = x + 0.5 - cx, dy = y + 0.5 - cy;
        // Vectors point right and up. w > 0 rotates clockwise on the screen, as y runs downwards.
        return std::vector<float>{static_cast<float>(rgb[0]),  static_cast<float>(rgb[1]), 0, 3,
                                  static_cast<float>(-w * dy), static_cast<float>(-w * dx)};
    };
    const MotionBlurResult r = vector_blur(frame_of(p), {.exposure = {1, 1}});
    int looked_at = 0;
    double least_change = 1;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            const double dx = x + 0.5 - cx, dy = y + 0.5 - cy, s = 1 / (1 + w * w);
            const double from_x = cx + s * (dx + w * dy), from_y = cy + s * (dy - w * dx);
            // Vertices at the frame's border have the mean of fewer vectors.
            if (from_x < 1.5 || from_x > 62.5 || from_y < 1.5 || from_y > 46.5) continue;
            ++looked_at;
            double rgb[2];
            ramp(from_x, from_y, rgb);
            // A position gets the colour of a pixel's centre, which is at most 0.5 px from its origin along
            // each axis. Triangles overlap by 0.001 px. The mean of the positions is the pixel's centre.
            constexpr double tolerance = 0.501 * 0.01 + 1e-5;
            EXPECT_NEAR(static_cast<double>(r.image.pixel(x, y)[0]), rgb[0], tolerance);
            EXPECT_NEAR(static_cast<double>(r.image.pixel(x, y)[1]), rgb[1], tolerance);
            if (dx * dx + dy * dy > 400)
                least_change =
                    std::min(least_change, std::hypot(rgb[0] - 0.01 * (x + 0.5), rgb[1] - 0.01 * (y + 0.5)));
        }
    }
    EXPECT_GT(looked_at, 1500);
    EXPECT_GT(least_change, 0.05);  // the field is far from the identity: ten tolerances
}

TEST_F(VectorFrameTest, WithoutDepthTheFasterIsInFront) {
    FlatPicture p = plate();
    p.channels[3] = "unused";
    const MotionBlurResult r = vector_blur(frame_of(p), {.exposure = {0.5, 0.5}});
    EXPECT_EQ(r.image.pixel(plate_x + plate_width + 2, plate_y + 10)[0], plate_colour);
}

TEST_F(VectorFrameTest, DepthDecidesWhoHides) {
    for (const float plate_z : {2.0F, 9.0F, std::numeric_limits<float>::infinity(), 1e10F}) {
        FlatPicture p = plate();
        p.values = [plate_z](int x, int y) {
            return in_plate(x, y) ? std::vector<float>{plate_colour, 0, 0, plate_z, 12, 0}
                                  : std::vector<float>{ground_colour, 0, 0, 5, 0, 0};
        };
        const MotionBlurResult r = vector_blur(frame_of(p), {.exposure = {0.5, 0.5}});
        EXPECT_EQ(r.image.pixel(plate_x + plate_width + 2, plate_y + 10)[0],
                  plate_z < 5 ? plate_colour : ground_colour)
            << plate_z;
    }
}

TEST_F(VectorFrameTest, TransparentPixelsAreBackground) {
    FlatPicture p = plate();
    p.channels.emplace_back("A");
    p.values = [](int x, int y) {  // the surroundings at depth 1 would hide the plate
        return in_plate(x, y) ? std::vector<float>{plate_colour, 0, 0, 2, 12, 0, 1}
                              : std::vector<float>{0, 0, 0, 1, 0, 0, 0};
    };
    const MotionBlurResult r = vector_blur(frame_of(p), {.exposure = {1, 1}});
    EXPECT_EQ(r.image.pixel(plate_x + plate_width + 11, plate_y + 10)[0], plate_colour);
    EXPECT_EQ(r.image.pixel(plate_x + 5, plate_y + 10)[0], 0);
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

TEST_F(VectorFrameTest, SameBitsForAnyNumberOfThreads) {
    const VectorFrame f = frame_of(plate());
    Image first;
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        const Image image = vector_blur(f, {.exposure = {-0.5, 1}}).image;
        if (threads == 1) first = image;
        EXPECT_EQ(image.rgb, first.rgb) << threads;
    }
}

TEST_F(VectorFrameTest, RefusesPixelsThatAreNoNumbersWithTheirPlace) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const auto& [channel, value] : std::vector<std::pair<std::size_t, float>>{
             {0, nan}, {2, inf}, {3, nan}, {3, -1.0F}, {3, -inf}, {4, nan}, {5, -inf}, {4, 3e6F}}) {
        FlatPicture p = plate();
        const auto usual = p.values;
        p.values = [&, usual](int x, int y) {
            std::vector<float> v = usual(x, y);
            if (x == 41 && y == 7) v[channel] = value;
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

TEST_F(VectorFrameTest, CommandBlursAndReports) {
    plate().write(in("plate.exr"));
    const Outcome r = run({"motionblur", in("plate.exr"), "-o", in("out.exr"), "--shutter", "0:1", "--json"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_EQ(json["method"], "lightfield");
    EXPECT_EQ(json["views"], 128);
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
    const std::string bytes = test::text_of(in("plate.exr"));
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
    static Image moved(const VectorChoice& choice) {
        return vector_blur(read_vector_frame(frame(1), choice), {.exposure = {1, 1}, .views = 4}).image;
    }
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
    const double unmoved = rmse(first, second), by_names = rmse(moved({}), second),
                 downwards = rmse(moved({.scale = glm::dvec2(1, 1)}), second),
                 whole_way = rmse(moved({.scale = glm::dvec2(2.43, -2.75)}), second);
    fmt::print("rmse to frame 2: unmoved {:.4f}, by the vectors {:.4f}, v downwards {:.4f}, scaled {:.4f}\n",
               unmoved, by_names, downwards, whole_way);
    EXPECT_GT(unmoved, 0.1);  // the frames differ clearly
    EXPECT_LT(by_names, 0.9 * unmoved);
    EXPECT_LT(by_names, 0.9 * downwards);
    EXPECT_LT(whole_way, 0.5 * by_names);
}

TEST_F(Beachball, BlursWithinTheWayAndKeepsTheRest) {
    const VectorFrame f = read_vector_frame(frame(1), {});
    const Image still = f.picture(), blurred = vector_blur(f, {.exposure = {0, 1}, .views = 64}).image;
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
}  // namespace postlens
