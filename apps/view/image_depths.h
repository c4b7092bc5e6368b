// Per pixel, the inverse focus distance that brings the object in the pixel into focus.
#pragma once

#include <cstdint>
#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Values of the brightest visible node of every pixel, row by row.
struct ImageDepths {
    /// Inverse focus distance, 1/m, that brings the node into focus. A reflection in a curved mirror has two
    /// such distances, of which this is the mean. Negative if no focus distance up to infinity brings the
    /// node into focus, as for some reflections.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object; 0: nothing was hit
};

/// Reads the frame's own instant. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);

}  // namespace postlens
