// What other programs' pictures give to the tables: light at the middle of a pixel.
#pragma once

#include <array>
#include <cstdint>

#include "records/quadtree.h"

namespace postlens {

/// Light of one depth in a pixel, taken to come from its middle: a pixel's value is a mean over its square,
/// and a response's share in a pixel is one as well.
struct PixelLight {
    int x = 0;                   ///< column of the pixel
    double inverse_depth = 0;    ///< 1/m; what covers what
    double spread_depth = 0;     ///< 1/m; whose circle of confusion it is spread by
    std::array<float, 3> rgb{};  ///< already times the weight
    float weight = 1;            ///< share of the pixel that it fills
    float covered = 0;           ///< of the weight, see LayerSplat; of what is hidden
    std::uint32_t surface = 0;   ///< which accumulator of `layers`
    bool hidden = false;         ///< behind something
};

/// Where it stands, with weight one in that pixel.
[[nodiscard]] inline PointSample middle_of_pixel(int x, int y) {
    return {.x = static_cast<float>(x) + 0.5F,
            .y = static_cast<float>(y) + 0.5F,
            .weight = {0.25F, 0.25F, 0.25F, 0.25F},
            .leaf_size = {1, 1, 1, 1}};
}

}  // namespace postlens
