// A sample file of the same frame with fewer records, for quick previews.
#pragma once

#include <cstdint>
#include <filesystem>

#include "records/sample_file.h"

namespace postlens {

/// Estimates the number of records, of all layers, that lie at pixel corners at the frame's own instant.
/// Counts them in at most 32 rows, spread over the file.
[[nodiscard]] double corner_records(const SampleFileReader& file);

/// Writes a sample file whose pixels are `by` times as wide and as high as those of `file`. It has the
/// samples of the frame's own instant, of all layers, at every by-th pixel corner in both directions. It has
/// no subdivided pixels and no key instants. Rows and columns that do not fill a wider pixel are left out at
/// the right, at the bottom, and in the overscan. `file` must be read at an exposure of 0 stops. Throws
/// Error(wrong_arguments) if no pixel is left, and the errors of reader and writer.
void write_coarser_file(const SampleFileReader& file, int by, const std::filesystem::path& path);

}  // namespace postlens
