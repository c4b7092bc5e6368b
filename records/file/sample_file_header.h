// Converts SampleHeader, the header of a sample file, to OpenEXR attributes and back.
#pragma once

#include <OpenEXR/ImfForward.h>
#include <string>
#include <vector>

#include "pictures/exr/exr_input.h"
#include "records/file/sample_file_layout.h"

namespace postlens {

/// Largest width and height of a raster in px, including overscan and the last row and column of pixel
/// corners. Up to this value, floats have a resolution of at least 1/64 px.
inline constexpr int largest_extent_px = 262144;

/// Checks the fields of a header. If a value is out of range, throws Error(invalid_input) with the name
/// `file` and the name of the field. The description of the motion is not checked here, because
/// motion_of_text() checks it.
void check_sample_header(const SampleHeader& header, const std::string& file);

/// Returns the checksum of all header fields as sixteen hexadecimal digits. docs/sample_file.md lists the
/// bytes.
[[nodiscard]] std::string header_checksum(const SampleHeader& header);

/// Returns the OpenEXR headers of all parts, in the order of the file.
[[nodiscard]] std::vector<Imf::Header> exr_headers_of(const SampleHeader& header, ChunkCompression records,
                                                      ChunkCompression picture);

/// Reads the header of a sample file from the attributes of its parts. Throws Error(invalid_input) if the
/// file is not a sample file of this version, or is damaged.
[[nodiscard]] SampleHeader sample_header_of(const ExrHeaders& headers, const std::string& file);

}  // namespace postlens
