// Predicts the size of the pinhole image within a sample file.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Predicts the compressed size, in bytes, of row y of the pinhole image in a file with this header. Returns
/// 0 if row y lies outside the image. `band` must contain the rows y and y + 1 of the records, because the
/// samples on the lower edges of the pixels are stored in row y + 1. The result is approximate, because a
/// file compresses up to 16 rows together.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
