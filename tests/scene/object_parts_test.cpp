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

Parts parts_in(const Mesh& mesh) {
    return parts_of(mesh, edges_of(mesh));
}

TEST(ObjectParts, TrianglesOfOnePartShareEdges) {
    EXPECT_EQ(parts_in(grid({{0, 1, 4}, {1, 5, 4}, {1, 2, 5}})), Parts());
    EXPECT_EQ(parts_in(Mesh()), Parts());
    // The last triangle connects the first two.
    EXPECT_EQ(parts_in(grid({{0, 1, 4}, {1, 2, 5}, {1, 5, 4}})), Parts());
}

TEST(ObjectParts, ACornerConnectsNothing) {
    EXPECT_EQ(parts_in(grid({{0, 1, 4}, {1, 2, 6}})), Parts({0, 1}));
    EXPECT_EQ(parts_in(grid({{10, 11, 14}, {0, 1, 4}, {11, 15, 14}, {1, 5, 4}, {2, 3, 7}})),
              Parts({0, 1, 0, 1, 2}));
}

TEST(ObjectParts, EqualPositionsAreOneWhateverTheirIndices) {
    Mesh apart;
    for (const glm::vec3& p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0),
                               glm::vec3(1, 1, 0), glm::vec3(-0.0F, 1, 0)})
        apart.positions.push_back(p);
    apart.triangles = {{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(parts_in(apart), Parts());
    apart.positions[5].x = 1e-6F;
    EXPECT_EQ(parts_in(apart), Parts({0, 1}));
}

TEST(ObjectParts, EdgesKnowTheTrianglesOnBothSides) {
    constexpr std::uint32_t none = MeshEdge::none;
    using Edges = std::vector<MeshEdge>;
    EXPECT_EQ(edges_of(grid({{0, 1, 4}, {5, 4, 1}})),
              Edges({{0, 1, 0, none}, {0, 4, 0, none}, {1, 4, 0, 1}, {1, 5, 1, none}, {4, 5, 1, none}}));
    // Three triangles at the edge from 0 to 1.
    EXPECT_EQ(edges_of(grid({{0, 1, 4}, {1, 0, 5}, {0, 1, 9}})), Edges({{0, 1, 0, 1},
                                                                        {0, 1, 1, 2},
                                                                        {0, 4, 0, none},
                                                                        {0, 5, 1, none},
                                                                        {0, 9, 2, none},
                                                                        {1, 4, 0, none},
                                                                        {1, 5, 1, none},
                                                                        {1, 9, 2, none}}));
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
