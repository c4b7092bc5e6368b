// Replaces the radiance in a sample file by the pixels of an image that is already blurred, so that a method
// can blur it again.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes a sample file with the depths and ids of the pixel corners in `file`, without hidden surfaces,
/// reflections and overscan. A corner's radiance is the mean of the four pixels of `image` around it.
///
/// `image` must have the size of the frame. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
