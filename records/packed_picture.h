// Predicts the size of the pinhole image within a sample file.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Predicts the compressed size, in bytes, of row y of the pinhole image in a file with this header, or 0
/// outside the image. `band` must contain rows y and y + 1, where the pixels' corners lie. The result is
/// approximate, because a file compresses up to 16 rows together.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
