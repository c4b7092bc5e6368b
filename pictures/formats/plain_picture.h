// Reads common image files with OpenEXR and libpng, which every program links. For these files, OpenImageIO,
// which takes 0.3 s to load, is not needed (pictures/formats/picture_library.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pictures/formats/picture_library.h"

namespace postlens {

/// Opens a PNG file that open_plain_png accepts, or a plain OpenEXR file: its first part is flat, has the
/// channels R, G, B or Y as half or float, with or without alpha, and states no colour space. Returns null
/// for all other files, including damaged ones; OpenImageIO must read those. For accepted files, both ways
/// give the same result (image_test.cpp). The header of an OpenEXR file must have been checked
/// (check_exr_headers).
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path);

/// Opens a PNG file with 8 bits per channel: grey, RGB or with a palette. The file must not have
/// transparency, an offset, a colour profile, or a gamma other than that of sRGB. Returns null for all other
/// files. `bytes` must outlive the reader.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes);

}  // namespace postlens
