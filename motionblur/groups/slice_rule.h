// Decides how `auto` blurs a moving object whose near and far parts move differently (parallax): by
// convolution in depth slices, or by the method lightfield.
#pragma once

#include <string>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "records/sample_header.h"

namespace postlens {

/// Bounding box, in raster px, of the area of the image over which a group of moving objects passes during
/// the exposure.
struct PassedBox {
    glm::dvec2 low_px{0}, high_px{0};
};
[[nodiscard]] PassedBox passed_box(const MovingGroup& group);

/// A group of moving objects passes over an area of the image during the exposure. Returns the fraction of
/// this area in which a static surface is farther than the nearest point of the group and nearer than its
/// farthest point.
[[nodiscard]] double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                                 const MovingGroup& group);

/// Returns why convolution is too inaccurate to blur the group `g` of moving objects, or an empty string if
/// it is accurate enough. Convolution moves the recorded image of the group along its motion path, in slices
/// by depth.
[[nodiscard]] std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g,
                                         const GroupTable& table, const std::vector<BandSurfaces>& bands,
                                         const SampleHeader& header);

/// Largest accepted parallax_px of a group of moving objects. The group is blurred in slices by depth, each
/// of which moves as a whole. With a larger parallax, even the largest number of slices is too coarse.
inline constexpr double most_parallax_px = 256;
/// Largest accepted value of share_among.
inline constexpr double most_among = 0.001;
/// Largest accepted value of torn_share.
inline constexpr double most_torn = 0.01;

}  // namespace postlens
