// Parts of meshes between the corners of cells, such as the tips of leaves, are found by their outlines.
#include "tracer/recording/mesh_outlines.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "tests/support/motion_frame.h"
#include "tests/support/quads.h"
#include "tests/support/scene_builder.h"

namespace postlens::test::mesh_outlines_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int width = 64, height = 48;
constexpr double tan_per_px = 36.0 / width / 50;

/// The point at depth `z_m` that the camera sees at raster position `px`.
dvec3 point_at(const dvec2& px, double z_m) {
    return dvec3((px.x - width / 2.0) * tan_per_px, -(px.y - height / 2.0) * tan_per_px, -1) * z_m;
}

std::shared_ptr<const Mesh> triangle(const dvec3& a, const dvec3& b, const dvec3& c) {
    auto out = std::make_shared<Mesh>();
    for (const dvec3& p : {a, b, c}) out->positions.emplace_back(p);
    out->triangles = {{0, 1, 2}};
    return out;
}

/// A thorn at 10 m. Its tip is inside pixel (20, 20), and only that part of it is above y = 21 px.
std::shared_ptr<const Mesh> thorn() {
    return triangle(point_at({20.5, 20.4}, 10), point_at({20.2, 30}, 10), point_at({20.8, 30}, 10));
}

MeshOutlines outlines_of(const Scene& scene) {
    return {scene, ObjectParts(scene), CameraModel(scene.cameras[0], scene.time_s), scene.time_s, 0, width, 0,
            height};
}

MeshOutlines::Shown wall(float z_m) {
    return {.id = 99, .part = 0, .z_m = {z_m, z_m, z_m, z_m}};
}

TEST(MeshOutlines, CrossTheCellsWithATip) {
    SceneBuilder b;
    b.add(thorn(), glowing(dvec3(1)));
    const MeshOutlines outlines = outlines_of(b.scene);
    EXPECT_TRUE(outlines.cross(20, 20, 1, wall(12)));
    EXPECT_FALSE(outlines.cross(20, 20, 0.25, wall(12)));
    EXPECT_TRUE(outlines.cross(20.25, 20.25, 0.5, wall(12)));
    EXPECT_TRUE(outlines.cross(20, 25, 1, wall(12)));
    for (const dvec2& other : {dvec2(20, 19), dvec2(19, 20), dvec2(21, 20), dvec2(20, 31), dvec2(63, 47)})
        EXPECT_FALSE(outlines.cross(other.x, other.y, 1, wall(12))) << other.x << " " << other.y;
    EXPECT_FALSE(outlines.cross(20, 20, 1, wall(9)));
    EXPECT_TRUE(outlines.cross(20, 20, 1, wall(std::numeric_limits<float>::infinity())));
    EXPECT_FALSE(
        outlines.cross(20, 20, 1, {.id = b.scene.objects[0].id, .part = 0, .z_m = {12, 12, 12, 12}}));
}

TEST(MeshOutlines, AnEdgeOnTheSideOfACellIsNotInIt) {
    SceneBuilder b;
    b.add(mesh_of({{point_at({10, 10}, 10), point_at({20, 10}, 10), point_at({20, 20}, 10),
                    point_at({10, 20}, 10)}}),
          glowing(dvec3(1)));
    const MeshOutlines outlines = outlines_of(b.scene);
    for (const int at : {9, 10, 15, 19, 20}) {
        for (const int side : {9, 10, 19, 20}) {
            EXPECT_FALSE(outlines.cross(at, side, 1, wall(12))) << at << " " << side;
            EXPECT_FALSE(outlines.cross(side, at, 1, wall(12))) << at << " " << side;
        }
    }
    // The diagonal of the quad is no outline, as the camera sees the triangles on both sides.
    EXPECT_FALSE(outlines.cross(15, 15, 1, wall(12)));
}

// The edge between the two faces of a roof is seen from above, but not where one face turns away.
TEST(MeshOutlines, AreWhereASurfaceTurnsAway) {
    for (const double back : {14.0, 30.0}) {
        // The ridge at x = 20.5 px and 10 m. The right face ends at x = 21.5 px, or to the left of the ridge.
        const double right = back == 14 ? 25.5 : 18.5;
        auto roof = std::make_shared<Mesh>();
        for (const dvec3& p :
             {point_at({20.5, 5}, 10), point_at({20.5, 40}, 10), point_at({10, 5}, 14),
              point_at({10, 40}, 14), point_at({right, 5}, back), point_at({right, 40}, back)})
            roof->positions.emplace_back(p);
        roof->triangles = {{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}};
        SceneBuilder b;
        b.add(roof, glowing(dvec3(1)));
        EXPECT_EQ(outlines_of(b.scene).cross(20, 20, 1, wall(50)), back == 30);
    }
}

// A leaf that lies on a slanted plane is not in front of it.
TEST(MeshOutlines, AnEdgeInThePlaneOfTheCornersIsNotInFront) {
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        for (const double in_front : {0.0, 0.01}) {
            SceneBuilder b;
            Camera& camera = b.scene.cameras[0];
            camera.projection = projection;
            camera.orthographic_width_m = 1000 * 36e-3 / 50 * 10 / 1000;
            const CameraModel model(camera, 0);
            // On the plane z = -10 m - 3 y.
            const auto on_plane = [&](const dvec2& px, double nearer) {
                const CameraRay ray = model.ray(px.x, px.y);
                const double t =
                    -(10 + ray.origin.z + 3 * ray.origin.y) / (ray.direction.z + 3 * ray.direction.y);
                return ray.origin + t * (1 - nearer) * ray.direction;
            };
            b.add(triangle(on_plane({20.5, 20.4}, in_front), on_plane({20.2, 30}, in_front),
                           on_plane({20.8, 30}, in_front)),
                  glowing(dvec3(1)));
            MeshOutlines::Shown shown = wall(0);
            for (int k = 0; k < 4; ++k) {
                shown.z_m[static_cast<std::size_t>(k)] =
                    static_cast<float>(-on_plane({20 + k % 2, 20 + k / 2}, 0).z);
            }
            EXPECT_EQ(outlines_of(b.scene).cross(20, 20, 1, shown), in_front > 0);
        }
    }
}

TEST(MeshOutlines, OfTooManyTheNearestAreKept) {
    std::vector<Quad> quads;
    const auto add = [&](double x, double z_m) {
        quads.push_back({point_at({x, 1}, z_m), point_at({x + 0.01, 1}, z_m), point_at({x + 0.01, 47}, z_m),
                         point_at({x, 47}, z_m)});
    };
    for (int i = 0; i < 630; ++i) add(0.1 + 0.1 * i, 10);
    add(40.55, 9);
    SceneBuilder b;
    b.add(mesh_of(quads), glowing(dvec3(1)));
    const MeshOutlines outlines = outlines_of(b.scene);
    EXPECT_TRUE(outlines.cross(40, 20, 1, wall(9.5)));
    int crossed = 0;
    for (int x = 0; x < width; ++x) crossed += outlines.cross(x, 20, 1, wall(12)) ? 1 : 0;
    // A strip has two edges of 46 px, so 4 edges a pixel are those of 133 strips, which cover 14 columns.
    EXPECT_GT(crossed, 10);
    EXPECT_LT(crossed, 17);
}

// All corners see the wall. Without subdivision, the records around the tip say that something is missing.
// With it, the cells with the tip are divided.
TEST(MeshOutlines, ATipBetweenCornersIsMarkedOrFound) {
    SceneBuilder b;
    b.add(Plane{{0, 0, -12}, {0, 0, 1}}, glowing(dvec3(0.5)));
    b.add(thorn(), glowing(dvec3(1)));
    TraceSettings settings;
    settings.seek_small_things = true;
    settings.camera.width = width;
    settings.camera.height = height;
    settings.subdivision.levels = 0;
    const TracedFrame coarse(b.scene, settings);
    EXPECT_TRUE(coarse.file().header().has_marks);
    RecordBand band;
    coarse.file().read(coarse.file().y_begin(), coarse.file().y_end(), band);
    for (const Record& r : band.records) {
        const bool around = (r.x == 20 || r.x == 21) && r.y >= 20 && r.y <= 30;
        EXPECT_EQ(r.mark, around ? RecordMark::gap : 0) << r.x << " " << r.y;
    }
    settings.subdivision.levels = 2;
    const TracedFrame fine(b.scene, settings);
    fine.file().read(fine.file().y_begin(), fine.file().y_end(), band);
    std::size_t thorns = 0;
    for (const Record& r : band.records) thorns += r.id == b.scene.objects[1].id ? 1 : 0;
    EXPECT_GT(thorns, 0U);
}

}  // namespace
}  // namespace postlens::test::mesh_outlines_test
