// Replaces the radiance in a sample file by the pixels of a motion-blurred image. A method then adds the blur
// of a lens.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes a sample file `path` with the surfaces in `file` that the pinhole sees directly. Their colours come
/// from `image`, which must be of equal size. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
