// Writes an impulse response as an image file.
#pragma once

#include <filesystem>
#include <string>

#include "lens/response_grid.h"

namespace postlens {

/// Writes OpenEXR with one float channel Y, the energy per pixel. The file is written atomically. Throws
/// Error(cannot_write), and Error(wrong_arguments) unless the name ends in .exr.
void write_response(const std::filesystem::path& path, const ResponseGrid& grid);

}  // namespace postlens
