// What the pinhole picture of a sample file takes in it.
#pragma once

#include <cstdint>

#include "records/sample_file.h"

namespace postlens {

/// Bytes that row y of the picture will take about in a file of this header, from the records of rows y and y
/// + 1, which `band` must hold: packed alone, where a file packs up to 16 rows together. 0 outside the
/// raster.
[[nodiscard]] std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                                 const RecordBand& band, int y);

}  // namespace postlens
