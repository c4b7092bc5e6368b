// Computes, for each pixel, the focus distance that brings the object in the pixel into focus. The inverses
// of these distances are stored.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "records/sample_file.h"

namespace postlens {

/// Inverse focus distance and id of the surface that each pixel shows, row by row. In a sample file, this is
/// the brightest surface that the pinhole sees in the pixel. In another program's image, it is the sample at
/// which the accumulated alpha reaches one half.
struct ImageDepths {
    /// Inverse focus distance, in 1/m, at which the surface is in focus. A reflection in a curved mirror may
    /// be in focus at two distances. The value is then the mean of their inverses. It is negative for some
    /// reflections that cannot be brought into focus.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object, or 0 if nothing was hit
};

/// Computes the depths at the frame's own instant. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);
/// Computes the depths of another program's image. Pixels that the file does not store are infinitely far and
/// have the id 0.
[[nodiscard]] ImageDepths image_depths(const ForeignPicture& picture);

}  // namespace postlens
