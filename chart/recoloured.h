// The frame's own corners with the colours of another picture: blurring what is blurred already.
#pragma once

#include <filesystem>

#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes to `path` a sample file of the corners' depths and ids as in `file`, without subdivision, layers,
/// trees, border and keys, in the colours of `image`, which has the frame's size; a corner's is the mean of
/// the pixels around it. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
