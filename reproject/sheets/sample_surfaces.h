// Finds the surfaces that each eye ray hits: directly, or also by reflection and transmission.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_header.h"

namespace postlens {

/// A surface, visible or hidden behind others, at one point sample. Its radiance includes everything that is
/// seen in it by reflection and refraction.
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
    /// Flags (Record::mark) of all surfaces that are seen in this one by reflection ([0]) or transmission
    /// ([1]), combined by bitwise OR. For example, one flag tells that a texture is finer than the samples.
    std::array<std::uint8_t, 2> marks_below{};
    /// RGB radiance that this surface sends to the eye by reflection ([0]) and by transmission ([1]). It
    /// contains the light of the surfaces seen directly in this surface, and of those seen in it by further
    /// reflections and refractions.
    std::array<std::array<float, 3>, 2> below{};
    /// Largest difference, in 1/m, between the matrix W of this surface and that of what is seen in it by
    /// reflection ([0]) or transmission ([1]). W tells how an image moves with the lens point. If the
    /// difference is small, the reflection may be drawn as if painted on the surface. Infinity if it is too
    /// bright for this.
    std::array<float, 2> strays{};
};
[[nodiscard]] constexpr std::uint8_t child_bit(NodePath::Bounce b) {
    return static_cast<std::uint8_t>(1U << (static_cast<std::uint32_t>(b) - 1));
}

/// Returns whether two neighbouring eye rays may hit one continuous surface. This is assumed if the line
/// between the two hits is inclined by at most 88.6 degrees to the film, that is, if the difference of the
/// depths is at most 40 times the distance between the rays.
/// - `low_inverse_z`, `high_inverse_z`: inverse depths of the farther and the nearer hit, 1/m
/// - `across`: distance between the rays on the film, divided by the film distance; for an orthographic
///   camera, distance between the rays in m
[[nodiscard]] bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective);
/// Returns the width of one pixel in the units that is_one_surface needs. For a perspective camera, this is
/// the pixel's width on the film divided by the film distance. For an orthographic camera, it is the pixel's
/// width in m.
[[nodiscard]] double across_per_px(const SampleHeader& header);

/// The surfaces that eye rays reach directly, not by reflection: for each ray, the visible one and those
/// hidden behind it. Ray i has the elements [offsets[i], offsets[i + 1]), from near to far.
struct SampleSurfaces {
    std::vector<LayerSurface> surfaces;
    std::vector<std::uint32_t> offsets;
};

/// Finds the directly seen surfaces along each eye ray, visible or hidden, from near to far.
/// `points`: the eye rays, read from `band`, from row y_begin on
void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out);

/// All surfaces that eye rays hit, directly or after reflections and refractions. Ray i has the elements
/// [offsets[i], offsets[i + 1]) of `nodes`: first the visible surface (layer 0), then hidden ones (layers 1,
/// 2, ...). Within a layer, they are sorted by the sequence of reflections and transmissions.
struct SampleTrees {
    std::vector<TreeSurface> nodes;
    std::vector<std::uint32_t> offsets;
    bool any_below = false;  ///< false if all `below` are black
};

/// Finds all surfaces that eye rays hit. `primary` gets those that are hit directly, and `deeper` those that
/// are hit after a reflection or transmission.
/// - `points`: the eye rays, read from `band`, from row `y_begin` on
/// - `bright_above`: limit of radiance; reflections and refractions above it are always drawn as separate
///   surfaces
void find_trees(const RecordBand& band, const PointSamples& points, int y_begin, float bright_above,
                SampleTrees& primary, SampleTrees& deeper);

}  // namespace postlens
