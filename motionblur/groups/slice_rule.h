// Decides how `auto` blurs a moving object whose near and far parts move differently (parallax): by
// convolution in depth slices, or by the method lightfield.
#pragma once

#include <string>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "records/sample_header.h"

namespace postlens {

/// Bounding box of the area over which a group moves, in raster px.
struct PassedBox {
    glm::dvec2 low_px{0}, high_px{0};
};
[[nodiscard]] PassedBox passed_box(const MovingGroup& group);

/// Returns the fraction of a moving group's path area in which static surfaces lie between the group's
/// nearest and farthest depths.
[[nodiscard]] double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                                 const MovingGroup& group);

/// Returns why convolution in depth slices is too inaccurate for a group of moving objects, which then needs
/// the method lightfield. Returns an empty string if convolution is accurate enough.
[[nodiscard]] std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g,
                                         const GroupTable& table, const std::vector<BandSurfaces>& bands,
                                         const SampleHeader& header);

/// Largest accepted parallax, in px. Parallax is the difference between the displacements of a group's
/// nearest point and farthest point. With more parallax, `most_slices` depth slices would be too coarse.
inline constexpr double most_parallax_px = 256;
/// Largest accepted value of share_among.
inline constexpr double most_among = 0.001;
/// Largest accepted value of torn_share.
inline constexpr double most_torn = 0.01;

}  // namespace postlens
