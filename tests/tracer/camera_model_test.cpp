// Rays through the film of a camera, and cameras that are refused.
#include "tracer/camera_model.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "core/error.h"
#include "scene/scene.h"

namespace postlens::test::camera_model_test {
namespace {

using glm::dvec3;

TEST(Camera, RaysGoThroughTheFilm) {
    Camera c;
    c.focal_length_mm = 50;
    c.width = 960;
    c.height = 540;
    const CameraModel m(c, 0);
    EXPECT_NEAR(m.pixel_pitch_mm, 36.0 / 960, 1e-15);
    const CameraRay corner = m.ray(960, 0);
    EXPECT_NEAR(corner.direction.x / -corner.direction.z, 18.0 / 50, 1e-12);
    EXPECT_NEAR(corner.direction.y / -corner.direction.z, 10.125 / 50, 1e-12);
    EXPECT_NEAR(corner.cos_axis, -corner.direction.z, 1e-15);

    c.focal_length_mm.reset();
    c.vertical_fov_degrees = 45;
    c.fov_between_pixel_centres = true;
    c.width = c.height = 512;
    const CameraModel nff(c, 0);
    const CameraRay first_row = nff.ray(256, 0.5);
    EXPECT_NEAR(std::atan2(first_row.direction.y, -first_row.direction.z) * 180 / std::numbers::pi, 22.5,
                1e-9);

    c.projection = Camera::Projection::orthographic;
    c.orthographic_width_m = 4;
    const CameraModel ortho(c, 0);
    EXPECT_NEAR(ortho.ray(0, 256).origin.x, -2, 1e-12);
    EXPECT_EQ(ortho.ray(0, 256).direction, glm::dvec3(0, 0, -1));
}

TEST(Camera, RefusesWhatIsNoView) {
    Camera c;
    c.look_at = c.position;
    EXPECT_THROW(CameraModel(c, 0), Error);
    Camera parallel;
    parallel.up = {0, 0, 1};
    EXPECT_THROW(CameraModel(parallel, 0), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.width = 0}), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.width = 1 << 20}), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.film_distance_mm = -1}), Error);
    EXPECT_THROW(CameraModel(Camera{}, 0, {.film_width_mm = std::nan("")}), Error);
}

}  // namespace
}  // namespace postlens::test::camera_model_test
