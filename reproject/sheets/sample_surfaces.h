// Converts records to surfaces: one per layer of a point sample, or one per node of its shading tree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_header.h"

namespace postlens {

/// One layer of a point sample: depth and id of the surface that the eye ray hits, and radiance of its whole
/// shading tree.
struct LayerSurface {
    float inverse_z = 0;  ///< 1/m; 0 if infinitely far
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
    /// For the reflected and the transmitted light: the flags (RecordMark) of all surfaces that contribute to
    /// it.
    std::array<std::uint8_t, 2> marks_below{};
    /// Reflected and transmitted radiance, summed over all surfaces seen by further reflections and
    /// refractions.
    std::array<std::array<float, 3>, 2> below{};
    /// For the reflected and the transmitted surfaces: largest difference (spectral norm, in 1/m) between
    /// their matrices W and this surface's W. Infinite if they are so bright that they are drawn separately.
    std::array<float, 2> strays{};
};
[[nodiscard]] constexpr std::uint8_t child_bit(NodePath::Bounce b) {
    return static_cast<std::uint8_t>(1U << (static_cast<std::uint32_t>(b) - 1));
}

/// Returns whether two samples can lie on one surface: the line through both is inclined to the film by at
/// most 88.6 degrees.
/// `across`: distance on the film, divided by the film distance for a perspective camera, or in m for an
/// orthographic one.
[[nodiscard]] bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective);
/// Returns the size of a pixel in the unit of is_one_surface's `across`: a tangent for a perspective camera,
/// m for an orthographic one.
[[nodiscard]] double across_per_px(const SampleHeader& header);

/// The surfaces of point samples. Sample i has the elements [offsets[i], offsets[i + 1]), from the nearest
/// layer to the farthest.
struct SampleSurfaces {
    std::vector<LayerSurface> surfaces;
    std::vector<std::uint32_t> offsets;
};

/// Finds the surfaces of point samples: layer 0 is visible from the pinhole, and layer n is the n-th surface
/// behind it. Layers without a directly seen surface are skipped.
/// `points` were read from `band`, from row y_begin on.
void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out);

/// The shading-tree nodes of point samples. Sample i has the elements [offsets[i], offsets[i + 1]), sorted
/// from near to far layers, and within a layer by path.
struct SampleTrees {
    std::vector<TreeSurface> nodes;
    std::vector<std::uint32_t> offsets;
    bool any_below = false;  ///< false if all `below` are black
};

/// Finds the surfaces of the samples `points`, one for each node of their shading trees. Primary nodes of all
/// layers go to `primary`, and reflected and transmitted nodes to `deeper`. `points` were read from `band`,
/// from row y_begin on.
///
/// A layer without a primary node shows surfaces that are hidden within a reflection or refraction of layer
/// 0. Its nodes are used only if their parents are recorded. Nodes brighter than `bright_above` in any
/// channel are never drawn as part of their parents (TreeSurface::strays).
void find_trees(const RecordBand& band, const PointSamples& points, int y_begin, float bright_above,
                SampleTrees& primary, SampleTrees& deeper);

}  // namespace postlens
