// Pictures of the commonest kinds, read by the libraries of their formats alone: OpenEXR's and libpng, which
// are there anyway, where OpenImageIO takes 0.3 s to load (records/picture_library.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "records/picture_library.h"

namespace postlens {

/// An OpenEXR file whose first part is flat, with the channels R, G, B or Y, with alpha or without, of half
/// or float, that does not say what colour space it is of; or a PNG file as below. Null for everything else,
/// damaged files among it: OpenImageIO is to be asked then, and says the same of what is read here
/// (image_test.cpp). The header of an OpenEXR file must have been checked (check_exr_headers).
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path);

/// A PNG file of 8 bits a channel, grey, RGB or of a palette, without transparency, an offset, a colour
/// profile or a gamma other than sRGB's. Its `bytes` must stay where they are. Null for everything else.
[[nodiscard]] std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes);

}  // namespace postlens
