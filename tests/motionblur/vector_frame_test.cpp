// Motion blur of flat images by their motion vectors: closed forms and occlusion.
#include "motionblur/vectors/vector_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "core/job.h"
#include "motionblur/vectors/vector_blur.h"
#include "motionblur/vectors/vector_sheets.h"
#include "tests/motionblur/flat_pictures.h"

namespace postlens::test::vector_frame_test {
namespace {

double ramp_mean(double a, double b) {  // of clamp(s, 0, 1) for s in [a, b]
    const auto integral = [](double s) { return s <= 0 ? 0 : s >= 1 ? s - 0.5 : 0.5 * s * s; };
    return (integral(b) - integral(a)) / (b - a);
}

/// The share of the light of pixel [x, x + 1) that comes from a bar [x0, x1), which moves by d > 0 while the
/// shutter is open. The part of the pixel right of an edge at e is clamp(x + 1 - e, 0, 1).
double bar_share(double x, double x0, double x1, double d) {
    return ramp_mean(x + 1 - x0 - d, x + 1 - x0) - ramp_mean(x + 1 - x1 - d, x + 1 - x1);
}

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

TEST_F(VectorFrameTest, SameBitsForAnyNumberOfThreads) {
    const VectorFrame f = frame_of(plate());
    Image first;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const Image image = vector_blur(f, {.exposure = {-0.5, 1}}).image;
        if (threads == 1) first = image;
        EXPECT_EQ(image.rgb, first.rgb) << threads;
    }
}

}  // namespace
}  // namespace postlens::test::vector_frame_test
