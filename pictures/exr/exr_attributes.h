// Attributes of OpenEXR headers, checked before the OpenEXR library sees them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "pictures/exr/chunk_codec.h"

namespace postlens {

/// Tests the size of an attribute. The OpenEXR library (3.1) reads the values of most types without regard to
/// the size that the file states. If the two differ, it continues inside another value, takes its bytes for a
/// size, and allocates gigabytes. Returns false if the library would read more or fewer bytes than `value`
/// has; true for all other values of OpenEXR's types, and for all values of other types.
[[nodiscard]] bool fills_its_size(std::string_view type, ByteView value);

/// Largest chunk accepted, uncompressed: 64 channels of 65536 px in chunks of 16 rows, or 4 channels in
/// chunks of 256 rows.
inline constexpr std::uint64_t largest_chunk_bytes = 256U << 20U;

/// Throws Error(invalid_input) if a header of an OpenEXR 2 file is truncated, has a value for which
/// fills_its_size is false, or makes the library allocate more than largest_chunk_bytes at once. Does not
/// check files of other formats.
void check_exr_headers(const std::filesystem::path& path);

}  // namespace postlens
