// Attributes of OpenEXR headers, checked before the OpenEXR library sees them.
#pragma once

#include <cstdint>
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

/// Of what is compressed together: 64 channels of 65536 px in chunks of 16 rows, or 4 of them in chunks of
/// 256.
inline constexpr std::uint64_t largest_chunk_bytes = 256U << 20U;

/// Throws Error(invalid_input) where a header of an OpenEXR 2 file is cut off, has a value for which
/// fills_its_size is false, or would have the library make room for more than largest_chunk_bytes at once.
/// Other files are left to who reads them.
void check_exr_headers(const std::filesystem::path& path);

}  // namespace postlens
