// Replaces a frame's radiance by the pixels of an image, so that a method can blur the image again.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes a sample file to `path` with the depths and ids of the pixel corners in `file`. A corner's radiance
/// is the mean of the four pixels of `image` around it.
///
/// `image` must have the size of the frame. The new file has one instant, and neither subdivision, hidden
/// layers, reflections nor overscan. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
