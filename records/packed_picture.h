// Predicts the size of the pinhole image within a sample file.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Predicts the size, in bytes, of row y of the pinhole image in a file with this header. Returns 0 for rows
/// outside the image. `band` must contain the rows y and y + 1, from whose records the image row is computed.
/// The size is approximate: a file compresses up to 16 rows together, and this function only one.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
