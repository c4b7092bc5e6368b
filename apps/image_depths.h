// Per pixel, the inverse focus distance that brings what the pixel shows into focus.
#pragma once

#include <cstdint>
#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Values of the brightest visible node of every pixel, row by row.
struct ImageDepths {
    /// Mean of the two inverse focus distances at which the node is in focus, 1/m. Negative if no focus
    /// distance up to infinity brings it into focus, as for some reflections.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object; 0: nothing was hit
};

/// Reads the frame's own instant. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);

}  // namespace postlens
