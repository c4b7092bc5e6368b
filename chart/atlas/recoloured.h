// Replaces the radiance of a frame by an image, so that a method can add a second blur to an image that is
// blurred already.
#pragma once

#include <filesystem>

#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// Writes to `path` a sample file with depths and ids of the pixel corners of `file` and radiance of `image`,
/// which has the size of the frame. The radiance at a corner is the mean of the four pixels around it. The
/// file has no subdivision, layers, reflected or refracted nodes, overscan or keys. Throws Error.
void write_recoloured(const SampleFileReader& file, const Image& image, const std::filesystem::path& path);

}  // namespace postlens
