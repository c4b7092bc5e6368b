// Makes a sample file from which a method adds lens blur to an image that already has motion blur. For this,
// the radiance of the file's records is replaced by the colours of the motion-blurred image's pixels.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes a sample file to `path`. It contains those surfaces of the sample file `file` that the pinhole sees
/// directly. Their colours are replaced by those of the image `image`, which must have the size of `file`.
/// Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
