// Checks the attributes of OpenEXR headers before the OpenEXR library reads them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "pictures/exr/chunk_codec.h"

namespace postlens {

/// The first four bytes of an OpenEXR file, as a little-endian number.
inline constexpr std::uint32_t exr_magic = 20000630;

/// Returns true if `value`, the bytes of an attribute of the type `type`, has the size that OpenEXR defines
/// for this type, or if OpenEXR does not define the type. After a wrong size, the OpenEXR library would read
/// on at a wrong position, and might allocate gigabytes.
[[nodiscard]] bool fills_its_size(std::string_view type, ByteView value);

/// Largest accepted size of an uncompressed chunk. It is enough for 64 channels of 65536 px in 16 rows, or
/// for 4 channels in 256 rows.
inline constexpr std::uint64_t largest_chunk_bytes = 256U << 20U;

/// Checks the headers of an OpenEXR 2 file. Accepts other formats without a check. Throws
/// Error(invalid_input) if:
/// - a header is truncated
/// - an attribute has a wrong size (fills_its_size)
/// - the library would allocate more than largest_chunk_bytes at once
void check_exr_headers(const std::filesystem::path& path);

}  // namespace postlens
