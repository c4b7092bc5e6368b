// An impulse response as a picture file.
#pragma once

#include <filesystem>
#include <string>

#include "lens/response_grid.h"

namespace postlens {

/// Throws Error(wrong_arguments) unless the name ends in .exr.
void check_response_path(const std::filesystem::path& path);

/// OpenEXR, one channel Y, float: energy per pixel. The file appears whole or not at all. Throws
/// Error(cannot_write).
void write_response(const std::filesystem::path& path, const ResponseGrid& grid);

}  // namespace postlens
