// The .toml scene format: shapes, transforms, motion, repetitions and instances.
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "scene/scene.h"
#include "tests/scene/toml_text.h"

namespace postlens::test::toml_objects_test {
namespace {

using glm::dvec3;

TEST_F(TomlText, SphereBoxDiscRectanglePlane) {
    const Sphere sphere =
        std::get<Sphere>(object("shape = 'sphere'\ncentre_m = [1, 2, 3]\nradius_m = 0.5\n").shape);
    EXPECT_EQ(sphere.centre, dvec3(1, 2, 3));
    EXPECT_EQ(sphere.radius, 0.5);
    const Box corners = std::get<Box>(object("shape = 'box'\nmin_m = [0, 1, 2]\nmax_m = [3, 4, 5]\n").shape);
    EXPECT_EQ(corners.min, dvec3(0, 1, 2));
    EXPECT_EQ(corners.max, dvec3(3, 4, 5));
    const Box cube = std::get<Box>(object("shape = 'box'\ncentre_m = [1, 0, 0]\nsize_m = 2\n").shape);
    EXPECT_EQ(cube.min, dvec3(0, -1, -1));
    EXPECT_EQ(cube.max, dvec3(2, 1, 1));
    const Box slab = std::get<Box>(object("shape = 'box'\nsize_m = [2, 4, 6]\n").shape);
    EXPECT_EQ(slab.max, dvec3(1, 2, 3));
    const Disc disc = std::get<Disc>(
        object("shape = 'disc'\ncentre_m = [1, 0, 0]\nnormal = [0, 2, 0]\nradius_m = 3\ninner_radius_m = 1\n")
            .shape);
    EXPECT_EQ(disc.centre, dvec3(1, 0, 0));
    EXPECT_EQ(disc.normal, dvec3(0, 1, 0));
    EXPECT_EQ(disc.radius, 3);
    EXPECT_EQ(disc.inner_radius, 1);
    const Rectangle r = std::get<Rectangle>(
        object("shape = 'rectangle'\ncorner_m = [1, 0, 0]\nedge_u_m = [2, 0, 0]\nedge_v_m = [1, 3, 0]\n")
            .shape);
    EXPECT_EQ(r.corner, dvec3(1, 0, 0));
    EXPECT_EQ(r.edge_u, dvec3(2, 0, 0));
    EXPECT_EQ(r.edge_v, dvec3(1, 3, 0));
    const Plane plane =
        std::get<Plane>(object("shape = 'plane'\npoint_m = [0, -1, 0]\nnormal = [0, 5, 0]\n").shape);
    EXPECT_EQ(plane.point, dvec3(0, -1, 0));
    EXPECT_EQ(plane.normal, dvec3(0, 1, 0));
}

TEST_F(TomlText, CylinderAndCone) {
    const Cone cylinder = std::get<Cone>(
        object("shape = 'cylinder'\nbase_m = [0, 0, 0]\napex_m = [0, 2, 0]\nradius_m = 0.5\n").shape);
    EXPECT_EQ(cylinder.base_radius, 0.5);
    EXPECT_EQ(cylinder.apex_radius, 0.5);
    EXPECT_EQ(cylinder.apex, dvec3(0, 2, 0));
    EXPECT_TRUE(cylinder.capped);
    const Cone cone = std::get<Cone>(
        object("shape = 'cone'\nbase_m = [0, 0, 1]\napex_m = [0, 2, 0]\nbase_radius_m = 1\ncapped = false\n")
            .shape);
    EXPECT_EQ(cone.base, dvec3(0, 0, 1));
    EXPECT_EQ(cone.base_radius, 1);
    EXPECT_EQ(cone.apex_radius, 0);
    EXPECT_FALSE(cone.capped);
    EXPECT_EQ(std::get<Cone>(object("shape = 'cone'\nbase_m = [0, 0, 1]\napex_m = [0, 2, 0]\nbase_radius_m = "
                                    "0\napex_radius_m = 3\n")
                                 .shape)
                  .apex_radius,
              3);
}

TEST_F(TomlText, MeshFacesBecomeTriangles) {
    const Object o = object(
        "shape = 'mesh'\npositions_m = [[0, 0, 0], [4, 2, 0], [0, 4, 0], [1, 2, 0], [0, 0, 1]]\n"
        "faces = [[0, 1, 2, 3], [0, 1, 4]]\nnormals = [[0, 0, 2], [0, 0, 1], [0, 0, 1], [0, 0, 1], [3, 0, "
        "4]]\n"
        "uvs = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]]\n");
    const Mesh& m = *std::get<std::shared_ptr<const Mesh>>(o.shape);
    ASSERT_EQ(m.triangles.size(), 3U);
    EXPECT_EQ(m.triangles[2], glm::uvec3(0, 1, 4));
    float area = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const glm::uvec3 t = m.triangles[i];
        area += 0.5F * glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x]).z;
    }
    EXPECT_FLOAT_EQ(area, 6);
    EXPECT_EQ(m.normals.at(0), glm::vec3(0, 0, 1));
    EXPECT_EQ(m.normals.at(4), glm::vec3(0.6F, 0, 0.8F));
    EXPECT_EQ(m.uvs.at(4), glm::vec2(0.5F, 0.5F));
}

TEST_F(TomlText, TransformsScaleThenTurnThenMove) {
    const auto m = [&](const std::string& keys) {
        return object("shape = 'sphere'\nradius_m = 1\n" + keys).world_from_object;
    };
    EXPECT_EQ(m(""), glm::dmat4(1));
    expect_near(
        at(m("translate_m = [1, 2, 3]\nrotate_degrees = 90\nrotate_axis = [0, 0, 7]\nscale = [2, 1, 1]\n"),
           {1, 0, 0}),
        {1, 4, 3});
    expect_near(at(m("scale = 3\n"), {1, 1, 1}), {3, 3, 3});
    // Three angles rotate about x first, then y, then z.
    expect_near(at(m("rotate_degrees = [90, 0, 90]\n"), {0, 1, 0}), {0, 0, 1});
    expect_near(at(m("rotate_degrees = [90, 90, 0]\n"), {0, 1, 0}), {1, 0, 0});
    expect_near(at(m("rotate_degrees = [0, 90, 90]\n"), {1, 0, 0}), {0, 0, -1});
    expect_near(at(m("quaternion = [1, 0, 0, 1]\n"), {1, 0, 0}), {0, 1, 0});  // w first; any length
    expect_near(at(m("matrix = [[0, -2, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]\n"), {1, 1, 1}), {3, 7, 8});
    expect_near(at(m("matrix = [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]\n"), {0, 0, 0}),
                {5, 6, 7});
}

TEST_F(TomlText, MotionStandsBeforeTheOwnTransform) {
    const Scene s =
        read("[scene]\ntime_s = 1\n" + ball +
             "translate_m = [1, 0, 0]\nkeys = [{ time_s = 0 }, { time_s = 2, translate_m = [0, 4, 0], "
             "rotate_degrees = 90, rotate_axis = [0, 0, 1], scale = 3 }]\n");
    const Object& o = s.objects.at(0);
    ASSERT_EQ(o.keys.size(), 2U);
    EXPECT_EQ(o.keys[1].time_s, 2);
    EXPECT_EQ(o.keys[1].translation, dvec3(0, 4, 0));
    EXPECT_EQ(o.keys[1].scale, dvec3(3));
    expect_near(at(o.motion_base, {}), {1, 0, 0});
    expect_near(at(transform_at(o.keys, 2) * o.motion_base, {}), {0, 7, 0});
    EXPECT_EQ(o.world_from_object, transform_at(o.keys, 1) * o.motion_base);  // at the scene's instant
    const double half = std::sqrt(0.5);
    expect_near(at(o.world_from_object, {}), dvec3(0, 2, 0) + 2.0 * dvec3(half, half, 0));
}

TEST_F(TomlText, RepetitionsAreObjectsOfTheirOwn) {
    const std::string named =
        "[[object]]\nname = 'b'\nshape = 'sphere'\nradius_m = 1\ntranslate_m = [10, 0, 0]\nscale = 2\n";
    const Scene grid = read(named + "repeat = { count = [2, 1, 3], step_m = [1, 5, -1] }\n");
    ASSERT_EQ(grid.objects.size(), 6U);
    EXPECT_EQ(grid.objects[0].name, "b[0,0,0]");
    EXPECT_EQ(grid.objects[5].name, "b[1,0,2]");
    expect_near(at(grid.objects[5].world_from_object, {1, 0, 0}), {13, 0, -2});
    EXPECT_EQ(grid.objects[5].id, 6U);
    const Scene line = read(named + "repeat = { count = 3, step_m = [1, 0, -1] }\n");
    ASSERT_EQ(line.objects.size(), 3U);
    EXPECT_EQ(line.objects[2].name, "b[2]");
    expect_near(at(line.objects[2].world_from_object, {}), {12, 0, -2});
    const Scene listed = read(named + "repeat = { at_m = [[0, 0, 0], [0, 7, 0]] }\n");
    ASSERT_EQ(listed.objects.size(), 2U);
    EXPECT_EQ(listed.objects[1].name, "b[1]");
    expect_near(at(listed.objects[1].world_from_object, {}), {10, 7, 0});
}

TEST_F(TomlText, InstancesShowWhatTheyName) {
    const Scene s = read(
        "[[material]]\nname = 'red'\n[[material]]\nname = 'blue'\n"
        "[[object]]\nname = 'post'\nshape = 'cylinder'\nbase_m = [0, 0, 0]\napex_m = [0, 1, 0]\nradius_m = "
        "0.1\n"
        "hidden = true\nmaterial = 'red'\ncasts_shadows = false\n"
        "[[object]]\nname = 'fence'\nshape = 'instance'\nof = 'post'\nhidden = true\nrepeat = { count = 3, "
        "step_m = [1, 0, 0] }\n"
        "[[object]]\nname = 'knob'\nshape = 'sphere'\nradius_m = 0.2\ntranslate_m = [0, 1, 0]\nmaterial = "
        "'blue'\n"
        "[[object]]\nname = 'garden'\nshape = 'instance'\nof = ['fence', 'knob']\ntranslate_m = [0, 0, "
        "-5]\nscale = 2\n"
        "[[object]]\nname = 'blue fence'\nshape = 'instance'\nof = 'fence'\nmaterial = 'blue'\ncasts_shadows "
        "= true\n"
        "keys = [{ time_s = 0 }, { time_s = 1, translate_m = [0, 0, 1] }]\n");
    ASSERT_EQ(s.objects.size(), 1U + 4U + 3U);
    EXPECT_EQ(s.objects[0].name, "knob");
    for (std::size_t i = 1; i <= 4; ++i) {
        EXPECT_EQ(s.objects[i].name, "garden");
        EXPECT_EQ(s.objects[i].id, 2U);  // all parts of an instance share one id
    }
    expect_near(at(s.objects[3].world_from_object, {}), {4, 0, -5});
    expect_near(at(s.objects[4].world_from_object, {}), {0, 2, -5});
    EXPECT_EQ(s.objects[3].material, 0U);
    EXPECT_EQ(s.objects[4].material, 1U);
    EXPECT_FALSE(s.objects[3].casts_shadows);
    EXPECT_TRUE(s.objects[4].casts_shadows);
    for (std::size_t i = 5; i <= 7; ++i) {
        EXPECT_EQ(s.objects[i].id, 3U);
        EXPECT_EQ(s.objects[i].material, 1U);
        EXPECT_TRUE(s.objects[i].casts_shadows);
        EXPECT_EQ(s.objects[i].keys.size(), 2U);
    }
}

TEST_F(TomlText, InstancesShareTheirMesh) {
    const Scene s = read(
        "[[object]]\nname = 'm'\nshape = 'mesh'\npositions_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = "
        "[[0, 1, 2]]\n"
        "[[object]]\nshape = 'instance'\nof = 'm'\ntranslate_m = [0, 0, 1]\n");
    EXPECT_EQ(std::get<std::shared_ptr<const Mesh>>(s.objects.at(0).shape),
              std::get<std::shared_ptr<const Mesh>>(s.objects.at(1).shape));
}

}  // namespace
}  // namespace postlens::test::toml_objects_test
