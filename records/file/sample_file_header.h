// Converts SampleHeader, the header of a sample file, to OpenEXR attributes and back.
#pragma once

#include <OpenEXR/ImfForward.h>
#include <string>
#include <vector>

#include "pictures/exr/exr_input.h"
#include "records/file/sample_file_layout.h"

namespace postlens {

/// Largest width and height of a raster, px, including overscan and corners. Floats of this size have steps
/// of 1/64 px.
inline constexpr int largest_extent_px = 262144;

/// Throws Error(invalid_input), which names `file` and the field, if a value is out of range. Does not check
/// the motion; motion_of_text() checks it on reading.
void check_sample_header(const SampleHeader& header, const std::string& file);

/// Checksum of all header fields, as sixteen hexadecimal digits. docs/sample_file.md lists the bytes.
[[nodiscard]] std::string header_checksum(const SampleHeader& header);

/// OpenEXR headers of all parts, in the order of the file.
[[nodiscard]] std::vector<Imf::Header> exr_headers_of(const SampleHeader& header, ChunkCompression records,
                                                      ChunkCompression picture);

/// Reads the sample file's header from the attributes of the parts. Throws Error(invalid_input) if the
/// attributes contradict each other or the checksum, or if the file is not a sample file of this version.
[[nodiscard]] SampleHeader sample_header_of(const ExrHeaders& headers, const std::string& file);

}  // namespace postlens
