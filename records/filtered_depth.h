// Depths that went through the pixel's filter like colours: times coverage, or means of near and far.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace postlens {

/// A pixel whose depth is a mean of two.
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

/// Looks for, and mends in `depth` (row by row, numbers as in the file; 0, 1e9 and more, infinity and NaN are
/// nothing), what a filter made of depths at silhouettes. `alpha`: of each pixel, 0..1; 0: nothing is there.
///
/// Times coverage: at rims (0 < A < 1) beside opaque pixels, Z / A is within 5 % of one of them and Z of
/// none. Where at least 4 rims say so, and four times as many as say the contrary, all rims are divided.
///
/// Means: along rows and columns, up to 4 pixels that lead evenly from one plateau to another that differs by
/// a tenth and more. A depth that was not filtered jumps instead. Where at least 4 edges are such, and half
/// as many as jump, each of their pixels is a mean: with near and far on its sides, (v - far) / (near - far)
/// of it is near. Before nothing, a rim with an alpha belongs to its thing alone. Not looked for without
/// `means`: a Cryptomatte says better what is mixed, and is used with depths as they are.
[[nodiscard]] FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha,
                                                  std::size_t width, bool means = true);

}  // namespace postlens
