// An impulse response as a picture file.
#pragma once

#include <filesystem>
#include <string>

#include "lens/response_grid.h"

namespace postlens {

/// OpenEXR, one channel Y, float: energy per pixel. The file appears whole or not at all. Throws
/// Error(cannot_write), and Error(wrong_arguments) unless the name ends in .exr.
void write_response(const std::filesystem::path& path, const ResponseGrid& grid);

}  // namespace postlens
