// The parts of objects: pieces of a mesh that share no edge, and the shapes of a compound object.
#include "scene/object_parts.h"

#include <gtest/gtest.h>
#include <vector>

#include "tests/support/scene_builder.h"

namespace postlens::test::object_parts_test {
namespace {

using Parts = std::vector<std::uint32_t>;

/// Positions of a grid of 4 x 4, one unit apart.
Mesh grid(std::vector<glm::uvec3> triangles) {
    Mesh out;
    for (int i = 0; i < 16; ++i) out.positions.emplace_back(i % 4, i / 4, 0);
    out.triangles = std::move(triangles);
    return out;
}

TEST(ObjectParts, TrianglesOfOnePartShareEdges) {
    EXPECT_EQ(parts_of(grid({{0, 1, 4}, {1, 5, 4}, {1, 2, 5}})), Parts());
    EXPECT_EQ(parts_of(Mesh()), Parts());
    // The last triangle connects the first two.
    EXPECT_EQ(parts_of(grid({{0, 1, 4}, {1, 2, 5}, {1, 5, 4}})), Parts());
}

TEST(ObjectParts, ACornerConnectsNothing) {
    EXPECT_EQ(parts_of(grid({{0, 1, 4}, {1, 2, 6}})), Parts({0, 1}));
    EXPECT_EQ(parts_of(grid({{10, 11, 14}, {0, 1, 4}, {11, 15, 14}, {1, 5, 4}, {2, 3, 7}})),
              Parts({0, 1, 0, 1, 2}));
}

TEST(ObjectParts, EqualPositionsAreOneWhateverTheirIndices) {
    Mesh apart;
    for (const glm::vec3& p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0),
                               glm::vec3(1, 1, 0), glm::vec3(-0.0F, 1, 0)})
        apart.positions.push_back(p);
    apart.triangles = {{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(parts_of(apart), Parts());
    apart.positions[5].x = 1e-6F;
    EXPECT_EQ(parts_of(apart), Parts({0, 1}));
}

TEST(ObjectParts, HaveNumbersOfTheirOwnInAScene) {
    SceneBuilder b;
    const auto leaves = std::make_shared<const Mesh>(grid({{0, 1, 4}, {1, 2, 6}}));
    b.add(Sphere{{0, 0, -5}, 1}, matte(glm::dvec3(1)));
    EXPECT_FALSE(ObjectParts(b.scene).any());
    b.add(leaves, matte(glm::dvec3(1)));
    b.add(leaves, matte(glm::dvec3(1)));
    const ObjectParts parts(b.scene);
    EXPECT_TRUE(parts.any());
    EXPECT_EQ(parts.part(0, 7), 0U);
    EXPECT_EQ(parts.part(1, 0), 1U);
    EXPECT_EQ(parts.part(1, 1), 2U);
    EXPECT_EQ(parts.part(2, 0), 3U);
    EXPECT_EQ(parts.part(2, 1), 4U);
    EXPECT_TRUE(parts.of_mesh(0).empty());
}

TEST(ObjectParts, TheShapesOfACompoundObjectAreParts) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -5}, 1}, matte(glm::dvec3(1)));
    b.add(Sphere{{3, 0, -5}, 1}, matte(glm::dvec3(1)));
    EXPECT_FALSE(ObjectParts(b.scene).any());
    b.scene.objects[1].id = b.scene.objects[0].id;
    const ObjectParts parts(b.scene);
    EXPECT_TRUE(parts.any());
    EXPECT_NE(parts.part(0, 0), parts.part(1, 0));
}

}  // namespace
}  // namespace postlens::test::object_parts_test
