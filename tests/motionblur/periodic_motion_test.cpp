// Motion that repeats many times while the shutter is open. Instants at a regular distance may all show it in
// the same phase.
#include <gtest/gtest.h>

#include "motionblur/motion_blur.h"
#include "tests/support/motion_frame.h"

namespace postlens::test::periodic_motion_test {
namespace {

using glm::dvec3;

TEST(PeriodicMotion, ManyTimesToAndFroIsTheSameAsOnce) {
    constexpr double depth_m = 4, m_per_px = depth_m / px_per_m, way_m = 20 * m_per_px;
    const auto blurred = [&](std::vector<TransformKey> keys) {
        SceneBuilder b;
        b.add(Rectangle{{-18 * m_per_px, -10, -depth_m}, {6 * m_per_px, 0, 0}, {0, 20, 0}}, glowing(dvec3(1)))
            .keys = std::move(keys);
        return TracedFrame(b.scene, for_shutter()).blur(MotionMethod::lightfield).image;
    };
    std::vector<TransformKey> often;
    for (int i = 0; i <= 128; ++i)
        often.push_back({.time_s = i / 128.0, .translation = {i % 2 * way_m, 0, 0}});
    const Image once = blurred(from_to({way_m, 0, 0})), repeated = blurred(often);
    // The bar has two edges. Each of M views is wrong by up to 1/M at an edge that passes once, and by up to
    // 2/M at one that passes to and fro. M is 131 and 521.
    for (int x = 0; x < once.width; ++x)
        EXPECT_NEAR(once.pixel(x, 20)[0], repeated.pixel(x, 20)[0], 2.0 / 131 + 4.0 / 521) << x;
}

TEST(PeriodicMotion, WholeTurnsChangeTheShading) {
    // The box turns 16 times, so that it is in its recorded position at all eighths of the exposure.
    SceneBuilder b;
    std::vector<TransformKey>& keys = b.add(Box{{-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4}}, matte(dvec3(0.8))).keys;
    for (int i = 0; i <= 64; ++i) {
        keys.push_back({.time_s = i / 64.0,
                        .translation = {0, 0, -4},
                        .rotation = glm::angleAxis(glm::radians(90.0 * i), dvec3(0, 1, 0))});
    }
    b.point_light({3, 3, 0});
    EXPECT_TRUE(has_warning(TracedFrame(b.scene, for_shutter()).blur(MotionMethod::automatic), "light"));
}

}  // namespace
}  // namespace postlens::test::periodic_motion_test
