// Rule by which `auto` decides whether an object with parallax is convolved in slices of depth.
#pragma once

#include <string>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "records/sample_header.h"

namespace postlens {

/// Bounding box, raster px, of the area over which a group moves, including its recorded position.
struct PassedBox {
    glm::dvec2 low_px{0}, high_px{0};
};
[[nodiscard]] PassedBox passed_box(const MovingGroup& group);

/// Fraction of the box's area in which a surface outside all moving groups lies between this group's nearest
/// and farthest point. The order of depth is wrong there, because all slices of the group are composited at
/// its mean depth.
[[nodiscard]] double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                                 const MovingGroup& group);

/// Returns the reason why lightfield is the better method for groups[g], which has parallax, or an empty
/// string if convolve is the better method. Reasons are: the group's parallax exceeds `most_parallax_px`;
/// another object lies in the group's range of depth along its path; parts of the group uncover each other
/// (torn_share).
[[nodiscard]] std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g,
                                         const GroupTable& table, const std::vector<BandSurfaces>& bands,
                                         const SampleHeader& header);

/// Largest accepted parallax, px. With more parallax, there would be too many slices, or the slices would be
/// too coarse.
inline constexpr double most_parallax_px = 256;
/// Largest accepted value of share_among.
inline constexpr double most_among = 0.001;
/// Largest accepted value of torn_share.
inline constexpr double most_torn = 0.01;

}  // namespace postlens
