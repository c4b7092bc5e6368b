// Decides, for the method `auto`, whether a moving object with parallax is blurred in depth slices or by the
// light field method.
#pragma once

#include <string>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "records/sample_header.h"

namespace postlens {

/// Bounding box, in raster px, of the area over which a group moves, including its recorded position.
struct PassedBox {
    glm::dvec2 low_px{0}, high_px{0};
};
[[nodiscard]] PassedBox passed_box(const MovingGroup& group);

/// Returns the fraction of the group's passed_box in which a static surface lies in the group's range of
/// depth. Such a surface may be composited in the wrong order, because compositing places whole groups, not
/// their slices, at their depth.
[[nodiscard]] double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                                 const MovingGroup& group);

/// Decides whether groups[g], which has parallax, is better blurred by the light field method than by
/// convolution. Returns the reason, or an empty string if convolution is better. Possible reasons are:
/// - The group's parallax exceeds `most_parallax_px`.
/// - Another object lies in the group's range of depth along its path.
/// - Parts of the group move differently and leave gaps or overlap (torn_share).
[[nodiscard]] std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g,
                                         const GroupTable& table, const std::vector<BandSurfaces>& bands,
                                         const SampleHeader& header);

/// Largest accepted parallax, in px. With more parallax, `most_slices` depth slices would be too coarse.
inline constexpr double most_parallax_px = 256;
/// Largest accepted value of share_among.
inline constexpr double most_among = 0.001;
/// Largest accepted value of torn_share.
inline constexpr double most_torn = 0.01;

}  // namespace postlens
