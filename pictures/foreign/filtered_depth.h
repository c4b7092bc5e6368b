// Repairs depth channels that were filtered like colours. At silhouettes, such a filter multiplies depths by
// coverage, or mixes near and far depths.
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
    bool before_nothing = false;  ///< nothing was hit on the far side, according to depth or alpha
};

struct FilteredDepths {
    std::size_t divided = 0;        ///< pixels whose depth was multiplied by alpha and is now divided by it
    std::size_t taken_over = 0;     ///< edge pixels before empty space; now have their surface's depth
    std::vector<MixedDepth> mixed;  ///< ascending; each pixel now has the depth of the larger share
};

/// Detects depths that were filtered, and repairs them in `depth`. `depth` and `alpha` have one value per
/// pixel, row by row. `alpha` is 0 to 1. Nothing was hit where the depth is 0, 1e9 or more, infinite or NaN,
/// or where alpha is 0.
///
/// Depths may have been multiplied by coverage. This is detected at edge pixels (0 < alpha < 1) next to
/// opaque pixels. Such a pixel is evidence if its depth matches a neighbour's depth within 5 %, but only
/// after it is divided by alpha. It is counter-evidence if its depth matches only before the division. If
/// there are at least 4 pixels of evidence, and four times as many as pixels of counter-evidence, the depths
/// of all edge pixels are divided by alpha.
///
/// Depths may also be means of two depths. This is detected along rows and columns. Unfiltered depths jump at
/// an edge. Filtered depths form a ramp: they change monotonically, over up to 4 pixels, between two depths
/// that differ by 10 % or more. If there are at least 4 ramps, and at least half as many ramps as jumps, the
/// pixels in ramps count as mixed. In a mixed pixel of depth v, the near surface covers the fraction (v -
/// far) / (near - far). If alpha shows empty space behind an edge pixel, the pixel belongs to its surface
/// alone.
///
/// Means are repaired only if `means` is true. Set it to false if there is a Cryptomatte. A Cryptomatte
/// describes mixed pixels better and needs unchanged depths.
[[nodiscard]] FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha,
                                                  std::size_t width, bool means = true);

}  // namespace postlens
