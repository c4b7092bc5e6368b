// Converts records to surfaces, in one of two forms. The first form has one surface for each point sample and
// layer, with the radiance of the whole shading tree. The second has one surface for each node of the tree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_header.h"

namespace postlens {

/// One layer of a point sample: depth and id of the surface that the eye ray hits, and radiance of the whole
/// shading tree.
struct LayerSurface {
    float inverse_z = 0;  ///< 1/m; 0: infinitely far
    float r = 0, g = 0, b = 0;
    std::uint32_t id = 0;
};

/// One node of the shading tree as a surface.
struct TreeSurface {
    float inverse_z = 0;         ///< 1/z', 1/m
    std::array<float, 3> rgb{};  ///< radiance of this node, without its children
    std::uint32_t id = 0;
    NodePath path;
    std::uint32_t parent_id = 0;  ///< id of the parent node's object; 0 for a primary node
    std::uint8_t children = 0;    ///< bits (child_bit) of the bounces with a child node
    Mat2 w;                       ///< 1/m
    float bend = 0;               ///< Record::w_bend
    std::uint8_t mark = 0;        ///< Record::mark
    /// For each of the two children, the marks of all nodes in its subtree.
    std::array<std::uint8_t, 2> marks_below{};
    /// Radiance of the whole subtree of the reflected child node, and of the whole subtree of the transmitted
    /// child node.
    std::array<std::array<float, 3>, 2> below{};
    /// For each of the two children, the largest difference between the matrix W of a node in the child's
    /// subtree and that of this node (spectral norm, 1/m). Infinity if a node of the subtree is brighter than
    /// the argument `bright_above` of find_trees.
    std::array<float, 2> strays{};
};
[[nodiscard]] constexpr std::uint8_t child_bit(NodePath::Bounce b) {
    return static_cast<std::uint8_t>(1U << (static_cast<std::uint32_t>(b) - 1));
}

/// Whether two samples can lie on one surface. They can if the surface through both makes an angle of at most
/// 88.6 degrees with the film; a sphere reaches this angle half a pixel inside its outline. `across` is the
/// distance of the samples on the film, as a tangent (perspective) or in m (orthographic).
[[nodiscard]] bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective);
/// Size of a pixel in the unit of the argument `across` of is_one_surface: a tangent (perspective) or m
/// (orthographic).
[[nodiscard]] double across_per_px(const SampleHeader& header);

/// The surfaces of some point samples. Sample i has the elements [offsets[i], offsets[i + 1]) of `surfaces`,
/// nearest layer first.
struct SampleSurfaces {
    std::vector<LayerSurface> surfaces;
    std::vector<std::uint32_t> offsets;
};

/// Finds the surfaces that the point samples `points` show: one in each layer (0: visible from the pinhole;
/// n: the n-th surface behind it). Skips layers without a primary node (the surface that the eye ray itself
/// hits). `points` were read from the rows of `band` from y_begin on.
void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out);

/// The shading-tree nodes of some point samples. Sample i has the elements [offsets[i], offsets[i + 1]) of
/// `nodes`, nearest layer first. Within a layer, nodes are sorted by path.
struct SampleTrees {
    std::vector<TreeSurface> nodes;
    std::vector<std::uint32_t> offsets;
    bool any_below = false;  ///< false: all `below` are black
};

/// Finds the surfaces of the samples `points`, one for each node. Primary nodes of all layers are stored in
/// `primary`, reflected and transmitted nodes in `deeper`. `points` were read from the rows of `band` from
/// y_begin on.
///
/// A layer without a primary node contains surfaces that are hidden within a reflection or refraction of
/// layer 0. Of these, only nodes with a recorded parent are used. Nodes brighter than `bright_above` in any
/// channel are never drawn as part of their parent (TreeSurface::strays).
void find_trees(const RecordBand& band, const PointSamples& points, int y_begin, float bright_above,
                SampleTrees& primary, SampleTrees& deeper);

}  // namespace postlens
