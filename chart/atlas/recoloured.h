// Replaces the radiance of a frame by the pixels of an image. A method can then blur an image that is already
// blurred.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes a sample file to `path`. Its depths and ids are those of the pixel corners in `file`. The radiance
/// at a corner is the mean of the four pixels of `image` around the corner. `image` must have the size of the
/// frame. The written file has only one instant. It has no subdivision, hidden layers, reflected or refracted
/// nodes, or overscan. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
