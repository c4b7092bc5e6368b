// Reads common image files with OpenEXR and libpng, which are linked anyway, because OpenImageIO takes 0.3 s
// to load (pictures/formats/picture_library.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pictures/formats/picture_library.h"

namespace postlens {

/// Opens an OpenEXR file whose first part is flat and has the channels R, G, B or Y, with or without alpha,
/// of half or float, and no statement of a colour space; or a PNG file that open_plain_png accepts. Null for
/// all other files, including damaged ones, which need OpenImageIO. For files that are accepted, both give
/// the same result (image_test.cpp). The header of an OpenEXR file must have been checked
/// (check_exr_headers).
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path);

/// Opens a PNG file with 8 bits per channel, grey, RGB or with a palette, without transparency, offset,
/// colour profile or a gamma other than that of sRGB. `bytes` must outlive the reader. Null for all other
/// files.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes);

}  // namespace postlens
