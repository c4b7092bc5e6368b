// Converts the header of a sample file, SampleHeader, to OpenEXR attributes and back.
#pragma once

#include <OpenEXR/ImfForward.h>
#include <string>
#include <vector>

#include "pictures/exr/exr_input.h"
#include "records/file/sample_file_layout.h"

namespace postlens {

/// Largest width and height of a raster, including overscan and corners, px. Floats represent such positions
/// in steps of 1/64 px.
inline constexpr int largest_extent_px = 262144;

/// Throws Error(invalid_input), naming `file` and the field, if a value is out of range. Does not check the
/// motion, which motion_of_text() checks on reading.
void check_sample_header(const SampleHeader& header, const std::string& file);

/// Checksum of all fields, as sixteen hexadecimal digits; docs/sample_file.md lists the bytes.
[[nodiscard]] std::string header_checksum(const SampleHeader& header);

/// OpenEXR headers of all parts, in the order of the file.
[[nodiscard]] std::vector<Imf::Header> exr_headers_of(const SampleHeader& header, ChunkCompression records,
                                                      ChunkCompression picture);

/// Reads the header from the attributes of the parts, and checks them for consistency and against the
/// header's checksum. Throws Error(invalid_input) for files that are not sample files of this version.
[[nodiscard]] SampleHeader sample_header_of(const ExrHeaders& headers, const std::string& file);

}  // namespace postlens
