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

/// Returns true if `value` has exactly the size that the OpenEXR library reads for an attribute of this type,
/// or if OpenEXR does not define the type. For most types, the library (version 3.1) ignores the size that
/// the file states. If this size is wrong, the library reads the next attribute at a wrong position, and may
/// allocate gigabytes.
[[nodiscard]] bool fills_its_size(std::string_view type, ByteView value);

/// Largest accepted size of an uncompressed chunk. It is enough for 64 channels of 65536 px in chunks of 16
/// rows, or for 4 channels in chunks of 256 rows.
inline constexpr std::uint64_t largest_chunk_bytes = 256U << 20U;

/// Checks the headers of an OpenEXR 2 file. Throws Error(invalid_input) if a header is truncated, an
/// attribute's value does not fill its stated size (fills_its_size), or the library would allocate more than
/// largest_chunk_bytes at once. Files of other formats are accepted without a check.
void check_exr_headers(const std::filesystem::path& path);

}  // namespace postlens
