// Predicts the size of the pinhole image within a sample file.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Predicts approximately how many bytes row y of the pinhole image needs in a sample file. Returns 0 if row
/// y lies outside the image. `band` must contain the rows y and y + 1 of the records, because they contain
/// the corners of the pixels.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
