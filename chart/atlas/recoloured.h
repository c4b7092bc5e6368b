// Replaces the radiance in a sample file by the pixels of an image that is already blurred, so that a method
// can blur it again.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes the surfaces that the pinhole sees directly in `file` to `path`, with colours from `image`, which
/// must have the frame's size. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
