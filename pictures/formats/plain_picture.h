// Reads common image files with OpenEXR and libpng, which every program links. This avoids loading
// OpenImageIO, which takes 0.3 s (pictures/formats/picture_library.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pictures/formats/picture_library.h"

namespace postlens {

/// Opens a PNG file that open_plain_png accepts, or a plain OpenEXR file. In a plain file, the first part is
/// flat and states no colour space. It has the channels R, G, B or Y as half or float, with or without alpha.
/// Returns null for all other files, including damaged ones. OpenImageIO must then read them. Both ways of
/// reading give the same result. The header of an OpenEXR file must have been checked before
/// (check_exr_headers).
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path);

/// Opens a PNG file with 8 bits per channel that is grey, RGB or has a palette. Returns null for all other
/// files, and for files with transparency, an offset, a colour profile, or a gamma other than that of sRGB.
/// `bytes` must outlive the reader.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes);

}  // namespace postlens
