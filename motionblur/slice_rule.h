// What `auto` asks of an object that moves parallel to the film and has some depth before it convolves it in
// slices.
#pragma once

#include <string>
#include <vector>

#include "motionblur/band_surfaces.h"
#include "records/sample_header.h"

namespace postlens {

/// The box around where a group was recorded and where its path takes it, raster px.
struct PassedBox {
    glm::dvec2 low_px{0}, high_px{0};
};
[[nodiscard]] PassedBox passed_box(const MovingGroup& group);

/// Share of the box's area where a surface of no group lies between the group's nearest and farthest point:
/// slices are put in the order of depth as one, by their group's mean.
[[nodiscard]] double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                                 const MovingGroup& group);

/// Why groups[g], which has parallax, is better made by lightfield; empty: it is not. It is where its paths
/// differ by more than `most_parallax_px`, where something else lies in its depth on its way, and where it is
/// several surfaces that uncover each other.
[[nodiscard]] std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g,
                                         const GroupTable& table, const std::vector<BandSurfaces>& bands,
                                         const SampleHeader& header);

/// Beyond this, slices would be too many or too coarse.
inline constexpr double most_parallax_px = 256;
/// Of share_among: what stands in the way of a thin pole.
inline constexpr double most_among = 0.001;
/// Of torn_share.
inline constexpr double most_torn = 0.01;

}  // namespace postlens
