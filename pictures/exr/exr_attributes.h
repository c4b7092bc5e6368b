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

/// Tests the size of an attribute. For most types, the OpenEXR library (3.1) ignores the size that the file
/// states. If the stated size is wrong, the library continues inside another value, interprets its bytes as a
/// size, and allocates gigabytes. Returns false if the library would read more or fewer bytes than `value`
/// has. Otherwise returns true, also for types that OpenEXR does not define.
[[nodiscard]] bool fills_its_size(std::string_view type, ByteView value);

/// Largest accepted size of an uncompressed chunk: 64 channels of 65536 px in chunks of 16 rows, or 4
/// channels in chunks of 256 rows.
inline constexpr std::uint64_t largest_chunk_bytes = 256U << 20U;

/// Checks the headers of an OpenEXR 2 file. Throws Error(invalid_input) if a header is truncated, has an
/// attribute whose value does not fill its stated size (fills_its_size), or would make the library allocate
/// more than largest_chunk_bytes at once. Accepts files of other formats unchecked.
void check_exr_headers(const std::filesystem::path& path);

}  // namespace postlens
