// Repairs depth channels that were filtered like colours. At silhouettes, filtering multiplies depths by
// coverage, or replaces them by means of a near and a far depth.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace postlens {

/// A pixel whose depth is a mean of two depths.
struct MixedDepth {
    std::size_t pixel = 0;
    float near = 0, far = 0;      ///< depths on both sides; `far` may mean that nothing was hit
    float near_share = 0;         ///< 0 to 1
    bool before_nothing = false;  ///< nothing was hit on the far side, by depth or alpha
};

struct FilteredDepths {
    std::size_t divided = 0;        ///< pixels whose depth was multiplied by alpha; repaired by a division
    std::size_t taken_over = 0;     ///< edge pixels before empty space; now have their surface's depth
    std::vector<MixedDepth> mixed;  ///< ascending; their depth is now that of the larger share
};

/// Detects filtered depths and repairs them in `depth` (row by row, values as in the file). Depths of 0, 1e9
/// and more, infinity and NaN mean that nothing was hit, as does an `alpha` of 0. `alpha` has one value per
/// pixel, 0 to 1.
///
/// Depths multiplied by coverage are detected at edge pixels (0 < alpha < 1) next to opaque pixels. An edge
/// pixel is evidence if its depth divided by its alpha is within 5 % of a neighbour's depth, but its
/// undivided depth is not. If there are at least 4 such pixels, and four times as many as pixels with the
/// opposite evidence, the depths of all edge pixels are divided by alpha.
///
/// Means of two depths are detected along rows and columns. Unfiltered depths jump at an edge. Filtered ones
/// change monotonically over up to 4 pixels, from one depth to another that differs by 10 % or more. If there
/// are at least 4 such edges, and at least half as many as jumps, their pixels count as mixed: at depth v,
/// the near surface has the share (v - far) / (near - far). An edge pixel whose alpha shows empty space
/// behind it belongs to its surface alone. Means are repaired only if `means` is true. With a Cryptomatte it
/// should be false, because a Cryptomatte describes mixed pixels better and needs unchanged depths.
[[nodiscard]] FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha,
                                                  std::size_t width, bool means = true);

}  // namespace postlens
