// Attributes of OpenEXR headers, checked before the OpenEXR library sees them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "records/chunk_codec.h"

namespace postlens {

/// The OpenEXR library (3.1) reads the values of most types without a look at the size that the file gives
/// them. Where the two differ it goes on inside another value, takes what is there for a size, and asks for
/// gigabytes. False where it would read `value` as more or fewer bytes than there are; true for every other
/// value of a type that OpenEXR has, and for every value of other types.
[[nodiscard]] bool fills_its_size(std::string_view type, ByteView value);

/// Throws Error(invalid_input) where a header of an OpenEXR 2 file is cut off, or has a value for which
/// fills_its_size is false. Other files are left to who reads them.
void check_exr_headers(const std::filesystem::path& path);

}  // namespace postlens
