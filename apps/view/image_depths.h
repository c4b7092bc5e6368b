// For each pixel, the inverse of the focus distance at which the object in the pixel is in focus.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "records/sample_file.h"

namespace postlens {

/// Values of the surface that each pixel shows, row by row. In a sample file, it is the brightest visible
/// node. In another program's image, it is the sample at which the composited alpha reaches one half.
struct ImageDepths {
    /// Inverse focus distance, 1/m, at which the node is in focus. The image in a curved mirror has two such
    /// distances; the value is the mean of their inverses. The value is negative if no focus distance up to
    /// infinity brings the node into focus, as for some reflections.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object; 0: nothing was hit
};

/// Reads the frame's own instant. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);
/// Pixels of the raster that are not stored are infinitely far and have id 0.
[[nodiscard]] ImageDepths image_depths(const ForeignPicture& picture);

}  // namespace postlens
