// The header of a sample file: SampleHeader to OpenEXR attributes and back.
#pragma once

#include <OpenEXR/ImfForward.h>
#include <string>
#include <vector>

#include "records/exr_input.h"
#include "records/sample_file_layout.h"

namespace postlens {

/// Rasters no wider or higher, overscan and corners included: what float positions hold in 1/64 px.
inline constexpr int largest_extent_px = 262144;

/// Throws Error(invalid_input), naming `file` and the field, where a value is out of range. Of the motion
/// nothing is looked at: motion_of_text() refuses it when it is read.
void check_sample_header(const SampleHeader& header, const std::string& file);

/// Sixteen hexadecimal digits over all fields; docs/sample_file.md lists the bytes.
[[nodiscard]] std::string header_checksum(const SampleHeader& header);

/// The headers of all parts, in their order.
[[nodiscard]] std::vector<Imf::Header> exr_headers_of(const SampleHeader& header, ChunkCompression records,
                                                      ChunkCompression picture);

/// What the parts' attributes say, checked against each other and against the header's own checksum. Throws
/// Error(invalid_input) for what is not a sample file of this version.
[[nodiscard]] SampleHeader sample_header_of(const ExrHeaders& headers, const std::string& file);

}  // namespace postlens
