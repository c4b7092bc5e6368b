// For each pixel, the inverse of the focus distance at which the object in the pixel is in focus.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "records/sample_file.h"

namespace postlens {

/// Values of what each pixel shows, row by row: the brightest visible node of a sample file, or the sample
/// at which the composited alpha of another program's image reaches one half.
struct ImageDepths {
    /// Inverse focus distance, 1/m, at which the node is in focus. The image in a curved mirror has two such
    /// distances; this is the mean of their inverses. Negative if the node is never in focus, up to infinity,
    /// as for some reflections.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object; 0: nothing was hit
};

/// Reads the frame's own instant. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);
/// Pixels of the raster that are not stored are infinitely far and have id 0.
[[nodiscard]] ImageDepths image_depths(const ForeignPicture& picture);

}  // namespace postlens
