// Records as surfaces: per point sample and layer one surface with the colour of its whole shading tree.
#pragma once

#include <cstdint>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_header.h"

namespace postlens {

/// What is seen at one layer of a point sample: the primary node's depth and id, the colours of all its
/// nodes.
struct Surface {
    float inverse_z = 0;  ///< 1/m; 0: infinitely far
    float r = 0, g = 0, b = 0;
    std::uint32_t id = 0;
};

/// Whether surfaces of these inverse depths, `across` apart (tangent of the angle; orthographic: m), can be
/// one: whether it would slope by at most 88.6 degrees against the film, a sphere's last half pixel before
/// its outline.
[[nodiscard]] bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective);
/// The film's tangent, orthographic: m, per px.
[[nodiscard]] double across_per_px(const SampleHeader& header);

/// The surfaces of some point samples: sample i has [offsets[i], offsets[i + 1]), the nearest layer first.
struct SampleSurfaces {
    std::vector<Surface> surfaces;
    std::vector<std::uint32_t> offsets;
};

/// Of `points`, taken from the rows of `band` from y_begin on. A layer whose primary node is not recorded is
/// left out.
void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out);

}  // namespace postlens
