// Reads common image files with OpenEXR and libpng, which load fast. OpenImageIO takes 0.3 s to load, so it
// is loaded only for other files (pictures/formats/picture_library.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pictures/formats/picture_library.h"

namespace postlens {

/// Opens a simple PNG or OpenEXR file without OpenImageIO, because loading that library takes time. Returns
/// null for all other files, including damaged ones. `open_plain_png` states which PNG files are simple.
///
/// An OpenEXR file is simple if its first part is flat, states no colour space, and has half or float
/// channels: R, G, B or only Y, with or without alpha. check_exr_headers must have accepted it.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path);

/// Opens a PNG file that is grey or RGB with 8 bits per channel, or has a palette. Returns null for other
/// files, and if there is transparency, an offset, a colour profile or a gamma other than that of sRGB.
/// `bytes` must outlive the reader.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes);

}  // namespace postlens
