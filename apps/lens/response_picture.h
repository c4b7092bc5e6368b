// Writes an impulse response as an image file.
#pragma once

#include <filesystem>
#include <string>

#include "lens/response_grid.h"

namespace postlens {

/// Writes the impulse response `grid` as an OpenEXR file. Its float channel Y is the energy in each pixel.
/// The file is written atomically. Throws Error(cannot_write), or Error(wrong_arguments) if the name does not
/// end in .exr.
void write_response(const std::filesystem::path& path, const ResponseGrid& grid);

}  // namespace postlens
