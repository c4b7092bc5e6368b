// Size of the pinhole image within a sample file.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Approximate bytes of row y of the pinhole image in a file with this header, from the records of rows y and
/// y + 1, which `band` must hold. The row is compressed alone, whereas a file compresses up to 16 rows
/// together. 0 outside the raster.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
