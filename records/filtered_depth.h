// Repairs depth channels that were filtered like colours, so that depths at silhouettes are multiplied by
// coverage or are means of near and far.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace postlens {

/// A pixel whose depth is a mean of two depths.
struct MixedDepth {
    std::size_t pixel = 0;
    float near = 0, far = 0;  ///< numbers as in the file, of the pixels on both sides; `far` may be nothing's
    float near_share = 0;     ///< 0 to 1
    bool before_nothing = false;  ///< what is far is nothing, by its depth or its alpha
};

struct FilteredDepths {
    std::size_t divided = 0;     ///< pixels whose depth was the depth times their alpha, which now is it
    std::size_t taken_over = 0;  ///< rims before nothing that now have the depth of what they are the rim of
    std::vector<MixedDepth> mixed;  ///< by growing pixel; their depth is now that of the greater share
};

/// Detects filtered depths and repairs them in `depth` (row by row, values as in the file; 0, 1e9 and more,
/// infinity and NaN mean nothing was hit). `alpha`: per pixel, 0 to 1; 0: nothing is there.
///
/// Multiplied by coverage: detected at edge pixels (0 < A < 1) next to opaque ones, if Z / A is within 5 % of
/// the depth of a neighbour and Z is not. If at least 4 edge pixels, and four times as many as contradict,
/// show this, all edge pixels are divided by alpha.
///
/// Means of two depths: detected along rows and columns where up to 4 pixels lead evenly from one depth to
/// another that differs by a tenth or more; unfiltered depths jump there. If at least 4 edges, and half as
/// many as there are jumps, show this, each of their pixels counts as mixed, with the share (v - far) / (near
/// - far) of the near surface. In front of nothing, an edge pixel with alpha belongs to its surface alone.
/// Only with `means`: a Cryptomatte describes mixed pixels better, and needs the depths as they are.
[[nodiscard]] FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha,
                                                  std::size_t width, bool means = true);

}  // namespace postlens
