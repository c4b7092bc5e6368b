// Repairs depth channels that were filtered like colours. At silhouettes, such depths are multiplied by
// coverage or are means of a near and a far depth.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace postlens {

/// A pixel whose depth is a mean of two depths.
struct MixedDepth {
    std::size_t pixel = 0;
    float near = 0, far = 0;      ///< depths on both sides, as in the file; `far` may stand for nothing
    float near_share = 0;         ///< 0 to 1
    bool before_nothing = false;  ///< the far side is nothing, by its depth or its alpha
};

struct FilteredDepths {
    std::size_t divided = 0;     ///< pixels whose depth was multiplied by alpha and is now divided by it
    std::size_t taken_over = 0;  ///< edge pixels in front of nothing that now have the depth of their surface
    std::vector<MixedDepth> mixed;  ///< in ascending order; their depth is now that of the larger share
};

/// Detects filtered depths and repairs them in `depth` (row by row, values as in the file; 0, 1e9 and more,
/// infinity and NaN mean that nothing was hit). `alpha` is per pixel, 0 to 1; 0 means that nothing was hit.
///
/// Depths multiplied by coverage are detected at edge pixels (0 < A < 1) next to opaque ones: the depth Z
/// divided by A is within 5 % of the depth of a neighbour, and Z is not. If at least 4 edge pixels show this,
/// and four times as many as contradict it, all edge pixels are divided by alpha.
///
/// Means of two depths are detected along rows and columns: up to 4 pixels lead monotonically from one depth
/// to another that differs by 10 % or more, where unfiltered depths would jump. If at least 4 edges show
/// this, and at least half as many as there are jumps, each of their pixels counts as mixed, with the share
/// (v - far) / (near - far) of the near surface for a depth v. An edge pixel in front of nothing that has
/// alpha belongs to its surface alone. Means are repaired only with `means`: a Cryptomatte describes mixed
/// pixels better, and needs unchanged depths.
[[nodiscard]] FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha,
                                                  std::size_t width, bool means = true);

}  // namespace postlens
