// Records as surfaces: per point sample and layer one surface with the colour of its whole shading tree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_header.h"

namespace postlens {

/// What is seen at one layer of a point sample: the primary node's depth and id, the colours of all its
/// nodes.
struct LayerSurface {
    float inverse_z = 0;  ///< 1/m; 0: infinitely far
    float r = 0, g = 0, b = 0;
    std::uint32_t id = 0;
};

/// A node of the shading tree as a surface of its own: what is seen directly, in a mirror or through glass.
struct TreeSurface {
    float inverse_z = 0;         ///< of z', 1/m
    std::array<float, 3> rgb{};  ///< this node's alone
    std::uint32_t id = 0;
    NodePath path;
    std::uint32_t parent_id = 0;  ///< of what it is seen in; 0 for a primary node
    std::uint8_t children = 0;    ///< child_bit of the bounces that have a node here
    Mat2 w;                       ///< 1/m
    float bend = 0;               ///< Record::w_bend
    std::uint8_t mark = 0;        ///< Record::mark
    /// The colours of all nodes that go on from here by the reflection, by the transmission.
    std::array<std::array<float, 3>, 2> below{};
    /// How far W of any of them departs from this node's, 1/m: the greatest that a lens direction of length 1
    /// is moved by. Infinite where one is brighter than asked for.
    std::array<float, 2> strays{};
};
[[nodiscard]] constexpr std::uint8_t child_bit(NodePath::Bounce b) {
    return static_cast<std::uint8_t>(1U << (static_cast<std::uint32_t>(b) - 1));
}

/// Whether surfaces of these inverse depths, `across` apart (tangent of the angle; orthographic: m), can be
/// one: whether it would slope by at most 88.6 degrees against the film, a sphere's last half pixel before
/// its outline.
[[nodiscard]] bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective);
/// The film's tangent, orthographic: m, per px.
[[nodiscard]] double across_per_px(const SampleHeader& header);

/// The surfaces of some point samples: sample i has [offsets[i], offsets[i + 1]), the nearest layer first.
struct SampleSurfaces {
    std::vector<LayerSurface> surfaces;
    std::vector<std::uint32_t> offsets;
};

/// Of `points`, taken from the rows of `band` from y_begin on. A layer whose primary node is not recorded is
/// left out.
void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out);

/// The nodes of some point samples: sample i has [offsets[i], offsets[i + 1]), the nearest layer first, in
/// each by path.
struct SampleTrees {
    std::vector<TreeSurface> nodes;
    std::vector<std::uint32_t> offsets;
    bool any_below = false;  ///< whether some node's `below` may be more than black
};

/// As find_surfaces, with every node by itself: primary nodes, hidden ones included, into `primary`, all
/// others into `deeper`. Of a layer without a primary node, which is what a mirror or glass of layer 0 hides,
/// the nodes whose parent is known. `bright_above`: light above this in any channel may not be taken for its
/// mirror's own (TreeSurface::strays).
void find_trees(const RecordBand& band, const PointSamples& points, int y_begin, float bright_above,
                SampleTrees& primary, SampleTrees& deeper);

}  // namespace postlens
