// Repairs depth channels that were filtered like colours. At silhouettes, such a filter mixes near and far
// depths, or scales depths by the pixel's coverage.
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
    bool before_nothing = false;  ///< depth or alpha shows that nothing was hit on the far side
};

struct FilteredDepths {
    std::size_t divided = 0;        ///< pixels whose depth was multiplied by alpha and is now divided by it
    std::size_t taken_over = 0;     ///< edge pixels before empty space that got the depth of their surface
    std::vector<MixedDepth> mixed;  ///< sorted by pixel; each got the depth that covers more of it
};

/// Detects depths that were filtered, and repairs them in `depth`. `depth` and `alpha` have one value per
/// pixel, row by row. `alpha` is 0 to 1. Nothing was hit where the depth is 0, 1e9 or more, infinite or NaN,
/// or where alpha is 0.
///
/// Depths may have been multiplied by coverage. This is detected at edge pixels (0 < alpha < 1) next to
/// opaque pixels. Some of these pixels have a depth that matches the depth of a neighbour (within 5 %) only
/// after division by alpha. In others, the depth matches only before the division. If there are at least 4
/// pixels of the first kind, and at least four times as many as of the second kind, the depths of all edge
/// pixels are divided by alpha.
///
/// Depths may also be means of two depths. This is detected along rows and columns. Unfiltered depths jump at
/// an edge. Filtered depths form a ramp: they change monotonically, over up to 4 pixels, between two depths
/// that differ by 10 % or more. If there are at least 4 ramps, and at least half as many ramps as jumps, each
/// pixel in a ramp counts as mixed: it shows a near and a far surface. The near surface covers the fraction
/// (v - far) / (near - far) of a pixel of depth v. If alpha shows that there is only empty space behind an
/// edge pixel, the pixel gets the depth of the near surface.
///
/// Means are repaired only if `means` is true. Set it to false if there is a Cryptomatte. A Cryptomatte
/// describes mixed pixels better and needs unchanged depths.
[[nodiscard]] FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha,
                                                  std::size_t width, bool means = true);

}  // namespace postlens
