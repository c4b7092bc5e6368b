// Computes, for each pixel, the inverse of the focus distance that brings the object in the pixel into focus.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "records/sample_file.h"

namespace postlens {

/// Inverse focus distance and id of the surface that each pixel shows, row by row. In a sample file, the
/// surface is the brightest one that the pinhole sees in the pixel. In another program's image, it is the one
/// at which the alpha, accumulated from front to back, reaches one half.
struct ImageDepths {
    /// Inverse of the focus distance at which the surface is in focus, in 1/m. A reflection in a curved
    /// mirror may be in focus at two distances. The value is then the mean of both inverses. It is negative
    /// for some reflections that no lens can bring into focus.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object, or 0 if nothing was hit
};

/// Computes the depths of a sample file at the instant of the frame, without its further recorded instants.
/// Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);
/// Computes the depths of another program's image. Pixels that the file does not store are infinitely far and
/// have the id 0.
[[nodiscard]] ImageDepths image_depths(const ForeignPicture& picture);

}  // namespace postlens
