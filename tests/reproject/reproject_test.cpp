// Motion on the raster against a computation in world space, filling of holes, and images of a moving camera
// against distributed rays.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

#include "reproject/fill_gaps.h"
#include "reproject/raster_map.h"
#include "tests/support/motion_frame.h"
#include "tests/support/random_motion.h"
#include "tracer/render.h"

namespace postlens::test::reproject_test {
namespace {

using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

SampleHeader random_header(RandomNumbers& random, Projection projection) {
    SampleHeader h;
    h.width = 64;
    h.height = 48;
    h.projection = projection;
    h.film_distance_mm = 50;
    h.pixel_pitch_mm = projection == Projection::perspective ? 36.0 / 64 : 40;
    h.time_s = 0.25;
    h.world_from_camera = glm::translate(dmat4(1), random.in_box(2)) * glm::mat4_cast(random.turn(2));
    h.motion.camera =
        random_keys(random, {0, 0.4, 1}, {.way_m = 0.5, .angle = 0.3, .scale_low = 1, .scale_high = 1});
    h.motion.objects[7].keys = random_keys(random, {-0.2, 0.3, 0.7}, {.way_m = 0.5, .angle = 0.4});
    return h;
}

// The motion of raster positions, computed by points in world space. Points are homogeneous; w = 0 is a
// direction.
struct ThroughTheWorld {
    const SampleHeader& h;
    [[nodiscard]] dmat4 world_from_camera(double time_s) const {
        return transform_at(h.motion.camera, time_s) * glm::inverse(transform_at(h.motion.camera, h.time_s)) *
               h.world_from_camera;
    }
    [[nodiscard]] bool perspective() const { return h.projection == Projection::perspective; }
    [[nodiscard]] dvec4 point(const RasterPoint& p) const {
        const double x = p.x - h.width / 2.0, y = h.height / 2.0 - p.y;
        if (!perspective())
            return {x * h.pixel_pitch_mm / 1000, y * h.pixel_pitch_mm / 1000, -1 / p.inverse_z, 1};
        const dvec3 ray(x * h.pixel_pitch_mm / h.film_distance_mm, y * h.pixel_pitch_mm / h.film_distance_mm,
                        -1);
        return p.inverse_z == 0 ? dvec4(ray, 0) : dvec4(ray / p.inverse_z, 1);
    }
    [[nodiscard]] std::optional<RasterPoint> move(const RasterPoint& from, double from_s, double to_s,
                                                  const std::vector<TransformKey>* keys) const {
        dvec4 p = world_from_camera(from_s) * point(from);
        if (keys != nullptr) p = transform_at(*keys, to_s) * (glm::inverse(transform_at(*keys, from_s)) * p);
        const dvec4 c = glm::inverse(world_from_camera(to_s)) * p;
        if (!(-c.z > 0)) return std::nullopt;
        const double per =
            perspective() ? h.film_distance_mm / h.pixel_pitch_mm / -c.z : 1000 / h.pixel_pitch_mm;
        return RasterPoint{h.width / 2.0 + c.x * per, h.height / 2.0 - c.y * per, p.w / -c.z};
    }
};

class RasterMapTest : public testing::TestWithParam<Projection> {};

TEST_P(RasterMapTest, IsTheWayThroughTheWorld) {
    RandomNumbers random(11);
    int ahead = 0, behind = 0;
    for (int i = 0; i < 4000; ++i) {
        const SampleHeader h = random_header(random, GetParam());
        const FrameMotion motion(h);
        const ThroughTheWorld obvious{h};
        const bool infinite = GetParam() == Projection::perspective && i % 5 == 0;
        const RasterPoint from{random.in(-20, 84), random.in(-20, 68), infinite ? 0 : 1 / random.in(0.3, 9)};
        const double from_s = random.in(-0.5, 1.5), to_s = random.in(-0.5, 1.5);
        const std::uint32_t id = i % 2 == 0 ? 7 : 3;
        const auto expected =
            obvious.move(from, from_s, to_s, id == 7 ? &h.motion.objects.at(7).keys : nullptr);
        const auto got = motion.map(id, from_s, to_s)(from);
        // Close to the plane of the pinhole, positions are arbitrarily large and the sign is determined by
        // rounding.
        if (expected && std::abs(expected->x) + std::abs(expected->y) > 1e5) continue;
        ASSERT_EQ(got.has_value(), expected.has_value()) << i;
        if (!expected) {
            ++behind;
            continue;
        }
        ++ahead;
        // Tolerance: about fifty operations on values below 1e4 in double, divided by a depth of at least
        // 1e-3.
        const double tolerance =
            50 * 1e4 * 2.3e-16 * 1e3 * (1 + std::abs(expected->x) + std::abs(expected->y));
        EXPECT_NEAR(got->x, expected->x, tolerance) << i;
        EXPECT_NEAR(got->y, expected->y, tolerance) << i;
        EXPECT_NEAR(got->inverse_z, expected->inverse_z,
                    1e-9 * (1 + expected->inverse_z * expected->inverse_z))
            << i;
        EXPECT_EQ(got->inverse_z == 0, infinite);
    }
    EXPECT_GT(ahead, 2000);
    EXPECT_GT(behind, 20);
}

TEST_P(RasterMapTest, ThereAndBackIsNoWay) {
    RandomNumbers random(12);
    for (int i = 0; i < 500; ++i) {
        const SampleHeader h = random_header(random, GetParam());
        const FrameMotion motion(h);
        const RasterPoint from{random.in(0, 64), random.in(0, 48), 1 / random.in(2, 9)};
        const auto there = motion.map(7, 0.1, 0.8)(from);
        if (!there || there->inverse_z > 5) continue;
        const auto back = motion.map(7, 0.8, 0.1)(*there);
        ASSERT_TRUE(back);
        EXPECT_NEAR(back->x, from.x, 1e-8);
        EXPECT_NEAR(back->y, from.y, 1e-8);
        EXPECT_NEAR(back->inverse_z, from.inverse_z, 1e-10);
    }
}

TEST_P(RasterMapTest, IsExactlyNothingWhereNothingMoves) {
    RandomNumbers random(13);
    SampleHeader h = random_header(random, GetParam());
    h.motion.camera = {{.time_s = 0, .translation = {1, 2, 3}, .rotation = random.turn(1)}};
    const FrameMotion motion(h);
    EXPECT_TRUE(motion.map(3, -5, 5).identity());  // the object does not move
    EXPECT_TRUE(motion.map(0, -5, 5).identity());
    EXPECT_FALSE(motion.map(7, 0, 0.5).identity());
    EXPECT_TRUE(motion.map(7, 0.5, 0.5).identity());
    EXPECT_TRUE(motion.map(7, 0.7, 9).identity());  // after the object's last key
    EXPECT_TRUE(motion.map(7, -9, -0.2).identity());
    EXPECT_FALSE(motion.camera_moves(-5, 5));
    EXPECT_EQ(motion.moving_ids(), std::vector<std::uint32_t>{7});
    EXPECT_EQ(motion.breaks_s(7), (std::vector<double>{-0.2, 0, 0.3, 0.7}));
    EXPECT_EQ(motion.breaks_s(3), (std::vector<double>{0}));
    // A moving camera moves all objects on the raster, and points at infinity.
    h.motion.camera.push_back({.time_s = 1, .rotation = random.turn(1)});
    const FrameMotion turning(h);
    EXPECT_FALSE(turning.map(0, 0, 0.5).identity());
    EXPECT_TRUE(turning.map(0, 1, 2).identity());
    EXPECT_TRUE(turning.camera_moves(0.5, 0.6));
}

TEST_P(RasterMapTest, DisplacementsAndKeysReplaceWhatTheFileSays) {
    RandomNumbers random(14);
    const SampleHeader h = random_header(random, GetParam());
    FrameMotion motion(h);
    motion.set_displacement(3, [](double t) { return glm::dvec2(10 * t, -4 * t * t); }, {0.5});
    motion.set_displacement(7, [](double t) { return glm::dvec2(t, 0); }, {});
    for (const double inverse_z : {0.2, 3.0}) {
        const auto p = motion.map(3, 0.25, 2.25)({12, 20, inverse_z});
        ASSERT_TRUE(p);  // the displacement replaces the camera's motion, too; the depth does not change
        EXPECT_NEAR(p->x, 32, 1e-12);
        EXPECT_NEAR(p->y, 20 - 4 * (2.25 * 2.25 - 0.25 * 0.25), 1e-12);
        EXPECT_NEAR(p->inverse_z, inverse_z, 1e-15);
    }
    EXPECT_EQ(motion.breaks_s(3), std::vector<double>{0.5});
    EXPECT_TRUE(motion.map(7, 0.4, 0.4).identity());
    EXPECT_EQ(motion.moving_ids(), (std::vector<std::uint32_t>{3, 7}));
    // Keys that are set after a displacement give a rigid motion again, together with the camera's motion.
    const std::vector<TransformKey> keys = random_keys(random, {0, 1}, {.way_m = 0.3, .angle = 0.2});
    motion.set_keys(7, keys);
    const ThroughTheWorld obvious{h};
    const RasterPoint from{30, 22, 0.2};
    const auto got = motion.map(7, 0.1, 0.6)(from), expected = obvious.move(from, 0.1, 0.6, &keys);
    ASSERT_TRUE(got && expected);
    EXPECT_NEAR(got->x, expected->x, 1e-9);
    EXPECT_NEAR(got->y, expected->y, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Projections, RasterMapTest,
                         testing::Values(Projection::perspective, Projection::orthographic));

TEST(RasterMap, InfinityStaysBeforeAnOrthographicCamera) {
    RandomNumbers random(15);
    const SampleHeader h = random_header(random, Projection::orthographic);
    const auto p = FrameMotion(h).map(0, 0, 1)({5, 6, 0});
    ASSERT_TRUE(p);
    EXPECT_EQ(p->x, 5);
    EXPECT_EQ(p->y, 6);
    EXPECT_EQ(p->inverse_z, 0);
}

// Gaps ----------------------------------------------------------------------------------------------------

TEST(FillGaps, KeepsWhatIsKnownAndFillsFromAround) {
    RandomNumbers random(5);
    for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {1, 7}, {5, 3}, {17, 31}, {64, 48}}) {
        Image image(width, height);
        std::vector<float> weight(image.rgb.size() / 3);
        float low = 9, high = -9;
        for (std::size_t i = 0; i < weight.size(); ++i) {
            weight[i] = random.in(0, 1) < 0.3 ? static_cast<float>(random.in(1e-6, 8)) : 0.0F;
            for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * i + c] = static_cast<float>(random.in(0, 4));
            if (weight[i] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                low = std::min(low, image.rgb[3 * i + c]);
                high = std::max(high, image.rgb[3 * i + c]);
            }
        }
        const bool none = std::all_of(weight.begin(), weight.end(), [](float w) { return w == 0; });
        Image filled = image;
        fill_gaps(filled, weight);
        for (std::size_t i = 0; i < filled.rgb.size(); ++i) {
            if (weight[i / 3] > 0) {
                EXPECT_EQ(filled.rgb[i], image.rgb[i]);
            } else if (none) {
                EXPECT_EQ(filled.rgb[i], 0) << width << 'x' << height;
            } else {  // filled with means of known values, up to rounding
                EXPECT_GE(filled.rgb[i], low - 1e-5F);
                EXPECT_LE(filled.rgb[i], high + 1e-5F);
            }
        }
    }
}

TEST(FillGaps, NothingKnownIsBlackAtAnySize) {
    for (const auto& [width, height] : {std::pair(1, 1), {1, 2}, {33, 1}, {7, 9}}) {
        Image image(width, height);
        std::fill(image.rgb.begin(), image.rgb.end(), 3.0F);
        fill_gaps(image, std::vector<float>(image.rgb.size() / 3, 0));
        for (const float v : image.rgb) EXPECT_EQ(v, 0) << width << 'x' << height;
    }
}

TEST(FillGaps, ConstantSurroundingsGiveTheConstantWhateverStoodInTheGap) {
    Image image(37, 23);
    std::vector<float> weight(image.rgb.size() / 3, 1);
    std::fill(image.rgb.begin(), image.rgb.end(), 0.7F);
    for (int y = 3; y < 20; ++y) {
        for (int x = 9; x < 30; ++x) {
            weight[static_cast<std::size_t>(y * 37 + x)] = 0;
            image.pixel(x, y)[1] = x % 2 == 0 ? 1e30F : std::numeric_limits<float>::quiet_NaN();
        }
    }
    fill_gaps(image, weight);
    for (const float v : image.rgb) EXPECT_NEAR(v, 0.7F, 1e-5F);  // six levels of means of equal floats
}

// A moving camera against distributed rays ----------------------------------------------------------------

Scene room() {
    SceneBuilder b;
    for (int i = -8; i < 8; ++i) {  // stripes, so that there are edges everywhere
        const double shade = i % 2 == 0 ? 0.8 : 0.15;
        b.add(Rectangle{{i * 0.5, -3, -7}, {0.5, 0, 0}, {0, 6, 0}}, glowing({shade, 0.5, 1 - shade}));
    }
    b.add(Rectangle{{-0.9, -0.6, -4.5}, {0.7, 0, 0}, {0, 1.2, 0}}, glowing({0.9, 0.3, 0.1}));
    b.add(Sphere{{0.7, 0.2, -4}, 0.45}, glowing({0.2, 0.8, 0.4}));
    return b.scene;
}

class MovingCamera : public testing::TestWithParam<TransformKey> {};

// There are 128 views, each an instant at one position in the pixel. Along a moving edge the light has an
// error of 1/128; at a still edge, of 1/8 of the contrast (64 positions in 8 columns). At most a tenth of the
// pixels have still edges, of contrast 0.65: 0.65^2 / 64 / 12 / 10 is 52 dB. Leaves of 1/16 px give outlines
// to 1/32 px: (0.65 / 32)^2 / 3 / 2 is 42 dB, if half of the pixels had a still edge. The limit of 40 dB
// allows for the noise of 512 rays, at most 0.65 / sqrt(512) and much less with a low-discrepancy sequence.
TEST_P(MovingCamera, IsAsDistributedRaysSeeIt) {
    Scene scene = room();
    TransformKey end = GetParam();
    end.time_s = 1;
    scene.cameras[0].keys = {{.time_s = 0}, end};
    RenderSettings truth;
    truth.spp = 512;
    truth.shutter = TimeSpan{0, 1};
    const Image reference = render_picture(scene, truth).image;
    const TracedFrame frame(scene, for_shutter(4));
    const MotionBlurResult r = frame.blur(MotionMethod::lightfield);
    EXPECT_FALSE(has_warning(r, "uncovered"));
    EXPECT_GT(psnr(r.image, reference), 40);
    EXPECT_LT(psnr(frame.file().picture(), reference), 30);  // the motion changes the image clearly
}

INSTANTIATE_TEST_SUITE_P(
    Moves, MovingCamera,
    testing::Values(TransformKey{.rotation = glm::angleAxis(0.1, dvec3(0, 1, 0))},    // pan
                    TransformKey{.rotation = glm::angleAxis(-0.08, dvec3(1, 0, 0))},  // tilt
                    TransformKey{.rotation = glm::angleAxis(0.25, dvec3(0, 0, 1))},   // roll
                    TransformKey{.translation = {0, 0, -1.2}},                        // dolly
                    TransformKey{.translation = {0.5, 0.1, 0.3}}));

}  // namespace
}  // namespace postlens::test::reproject_test
