// Computes the inverse depth at which a lens must focus to show each pixel sharply.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/foreign/foreign_picture.h"
#include "records/sample_file.h"

namespace postlens {

/// The object id and the depth of one surface per pixel, row by row.
/// - For a sample file, it is the brightest surface that the pinhole sees in the pixel.
/// - For another program's image, it is the first surface at which the accumulated alpha reaches one half.
struct ImageDepths {
    /// For each pixel, the inverse of the focus distance, in 1/m, at which the pixel's surface is sharp. It
    /// is 0 for an infinite distance. It is negative if a mirror or glass makes the light converge, so that
    /// no focus distance makes the surface sharp.
    std::vector<float> inverse_per_m;
    std::vector<std::uint32_t> ids;  ///< id of the object, or 0 if nothing was hit
};

/// Computes the depths from a sample file. If objects move, the file may contain several instants. The depths
/// are those at the instant of the frame itself. Throws the errors of the reader.
[[nodiscard]] ImageDepths image_depths(const SampleFileReader& file);
/// Computes the depths of another program's image. A pixel that the file does not store has an infinite depth
/// and the id 0.
[[nodiscard]] ImageDepths image_depths(const ForeignPicture& picture);

}  // namespace postlens
