// Computes the inverse depth at which a lens must focus to show each pixel sharply.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "records/sample_file.h"

namespace postlens {

/// For each pixel, row by row: the object id of one surface, and the inverse of the focus distance at which
/// this surface is sharp.
/// - For a sample file, it is the brightest surface that the pinhole sees in the pixel.
/// - For another program's image, it is the first surface at which the accumulated alpha reaches one half.
struct ImageDepths {
    /// For each pixel, the inverse of the focus distance, in 1/m, at which a lens images the pixel's surface
    /// sharply. It is 0 if this distance is infinite. It is negative if a mirror or glass forms the image of
    /// the surface beyond infinity (converging light), where no lens can focus.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object, or 0 if nothing was hit
};

/// Computes the depths of a sample file at the instant of the frame. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);
/// Computes the depths of another program's image. A pixel that the file does not store has an infinite depth
/// and the id 0.
[[nodiscard]] ImageDepths image_depths(const ForeignPicture& picture);

}  // namespace postlens
