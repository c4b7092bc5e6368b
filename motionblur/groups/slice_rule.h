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

/// A moving group passes over an area of the image. Returns the fraction of this area in which static
/// surfaces lie between the group's nearest and farthest depths.
[[nodiscard]] double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                                 const MovingGroup& group);

/// A group of moving objects can be blurred by two methods: by convolution in depth slices, or by the method
/// `lightfield`, which averages views at many instants. Returns the reason why convolution is too inaccurate
/// for group `g`. Returns an empty string if it is accurate enough.
[[nodiscard]] std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g,
                                         const GroupTable& table, const std::vector<BandSurfaces>& bands,
                                         const SampleHeader& header);

/// Largest accepted parallax of a group of moving objects, in px. The parallax is the displacement in the
/// image of the group's nearest point minus that of its farthest point. If it is larger, even the largest
/// number of depth slices is too coarse.
inline constexpr double most_parallax_px = 256;
/// Largest accepted value of share_among.
inline constexpr double most_among = 0.001;
/// Largest accepted value of torn_share.
inline constexpr double most_torn = 0.01;

}  // namespace postlens
