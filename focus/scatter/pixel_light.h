// A sample of an image with depth that another program made. The methods `scatter` and `layers` blur it.
#pragma once

#include <array>
#include <cstdint>

#include "records/quadtree.h"

namespace postlens {

/// Light at one depth in a pixel of an image that another program made. The light is placed at the pixel's
/// centre, because the values of pixels are means over the pixel's area.
struct PixelLight {
    int x = 0;                   ///< column of the pixel
    double inverse_depth = 0;    ///< 1/m; for the order of compositing
    double spread_depth = 0;     ///< 1/m; for the circle of confusion
    std::array<float, 3> rgb{};  ///< multiplied by the weight
    float weight = 1;            ///< share of the pixel that the light fills
    float covered = 0;           ///< LayerSplat::covered, for hidden light
    std::uint32_t surface = 0;   ///< number of its surface in `layers`
    bool hidden = false;         ///< behind another sample
};

/// Returns a point sample of weight 1 at the centre of a pixel.
[[nodiscard]] inline PointSample middle_of_pixel(int x, int y) {
    return {.x = static_cast<float>(x) + 0.5F,
            .y = static_cast<float>(y) + 0.5F,
            .weight = {0.25F, 0.25F, 0.25F, 0.25F},
            .leaf_size = {1, 1, 1, 1}};
}

}  // namespace postlens
