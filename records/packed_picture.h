// Predicts the size of the pinhole image within a sample file.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Approximate size, bytes, of row y of the pinhole image in a file with this header; 0 outside the raster.
/// The row is computed from the records of rows y and y + 1, which `band` must contain. Each row is
/// compressed alone here, whereas a file compresses up to 16 rows together.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
