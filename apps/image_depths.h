// Per pixel, the depth at which what is seen there is in focus.
#pragma once

#include <cstdint>
#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Of every pixel's brightest visible node, row by row.
struct ImageDepths {
    /// Mean of the two inverse depths at which its image is in focus, 1/m; below 0: its image lies behind
    /// infinity.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< its object; 0: nothing
};

/// Reads the frame's own instant. Throws what the reader throws.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);

}  // namespace postlens
