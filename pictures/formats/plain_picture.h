// Reads common image files with OpenEXR and libpng, which every program links. This avoids loading
// OpenImageIO, which takes 0.3 s (pictures/formats/picture_library.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pictures/formats/picture_library.h"

namespace postlens {

/// Opens a PNG file that open_plain_png accepts, or a plain OpenEXR file. An OpenEXR file is plain if its
/// first part is flat, states no colour space, and has exactly the channels R, G, B or only Y. The channels
/// may be half or float, with or without alpha. OpenImageIO reads the same values from a plain file. Returns
/// null for all other files, including damaged ones. check_exr_headers must have accepted an OpenEXR file
/// before.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path);

/// Opens a PNG file that is grey or RGB with 8 bits per channel, or has a palette. Returns null for all other
/// files, and for files with transparency, an offset, a colour profile, or a gamma other than that of sRGB.
/// `bytes` must outlive the reader.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes);

}  // namespace postlens
