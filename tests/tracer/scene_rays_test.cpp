// Rays that find the light of one surface only (trace_elsewhere).
#include "tracer/distributed/scene_rays.h"

#include <gtest/gtest.h>
#include <vector>

#include "tests/support/scene_builder.h"

namespace postlens::test::scene_rays_test {
namespace {

using glm::dvec3;
using Radiances = std::vector<std::array<float, 3>>;

// A bright sphere, also seen in a tilted mirror of glass, before a wall that a point light illuminates.
class LampAndMirror : public testing::Test {
  protected:
    static constexpr std::uint32_t wall = 1, lamp = 2, plate = 3;

    static Scene made() {
        SceneBuilder b;
        b.add(board(-3, 3, -3, 3, 6), matte(dvec3(0.8)));
        b.add(Sphere{dvec3(0.9, 0, -3), 0.4}, glowing(dvec3(5, 4, 3)));
        Material both = mirror(0.5);
        both.transmission = dvec3(0.4);
        both.ior = 1;
        b.add(square(dvec3(-0.6, 0, -3), dvec3(1, 0, 0.4), 1.6), both);
        b.point_light(dvec3(0, 2, 0), dvec3(20));
        return b.scene;
    }
    static RenderSettings lens() {
        RenderSettings out;
        out.f_number = 2;
        out.focus_m = 4;
        return out;
    }

    const Scene scene_ = made();
    const RenderSetup setup_{scene_, lens()};
    std::vector<SightLine> lines_;

    LampAndMirror() {
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) lines_.push_back(line_through({x + 0.5, y + 0.5}));
        }
    }

    // The light above 1 that the node adds: all light minus the light with the node clamped to 1.
    [[nodiscard]] Radiances expected(const NodeIdentity& node) const {
        const SceneRays rays(setup_, {}, 1);
        Radiances all(lines_.size()), clamped(lines_.size());
        rays.trace(lines_, {}, all);
        rays.trace(lines_, less(node), clamped);
        for (std::size_t i = 0; i < all.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) all[i][c] -= clamped[i][c];
        }
        return all;
    }
    static LightElsewhere less(const NodeIdentity& node) {
        LightElsewhere out;
        out.of = [node](NodePath path, std::uint32_t parent_id, std::uint32_t id, const glm::dvec2&) {
            return NodeIdentity{path, parent_id, id} == node;
        };
        out.ids = {node.id};
        return out;
    }
    // Compares the light of a node with `expected`. Returns the numbers of traced rays.
    RayCounts check(const NodeIdentity& node) {
        const SceneRays rays(setup_, {}, 1);
        Radiances found(lines_.size());
        rays.trace_elsewhere(lines_, std::vector(lines_.size(), node), less(node), found);
        const Radiances right = expected(node);
        double sum = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            // Tolerance: rounding of radiances of up to 5.
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[i][c], right[i][c], 2e-6) << i;
            sum += static_cast<double>(found[i][0]);
        }
        EXPECT_GT(sum, 20);
        return rays.counts();
    }
};

TEST_F(LampAndMirror, DirectLightNeedsOnlyEyeRays) {
    const RayCounts counts = check({{}, 0, lamp});
    EXPECT_EQ(counts.eye, lines_.size());
    EXPECT_EQ(counts.reflect + counts.refract + counts.shadow, 0U);
}

TEST_F(LampAndMirror, ReflectedLightNeedsOnlyItsPath) {
    const RayCounts counts = check({NodePath().child(NodePath::Bounce::reflected), plate, lamp});
    EXPECT_GT(counts.reflect, 100U);
    EXPECT_EQ(counts.refract + counts.shadow, 0U);
}

}  // namespace
}  // namespace postlens::test::scene_rays_test
