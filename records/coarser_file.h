// Writes a sample file of the same frame with fewer, larger pixels, for quick previews.
#pragma once

#include <cstdint>
#include <filesystem>

#include "records/sample_file.h"

namespace postlens {

/// Estimates how many records (surface hits) of `file` lie exactly at pixel corners, at instant 0 (the first
/// recorded instant). write_coarser_file keeps only such records, because the pixels of a coarser file are
/// not subdivided. The estimate is extrapolated from at most 32 evenly spaced rows.
[[nodiscard]] double corner_records(const SampleFileReader& file);

/// Writes a sample file whose pixels are `by` times as wide and as high as those of `file`. The new file
/// keeps the samples at every by-th pixel corner in both directions, with all their layers. It has no
/// subdivided pixels, and only instant 0. Rows and columns at the borders are left out if they do not fill a
/// whole new pixel. `file` must have been opened with an exposure of 0 stops.
///
/// Throws Error(wrong_arguments) if no pixel is left. Also throws the errors of the reader and of the writer.
void write_coarser_file(const SampleFileReader& file, int by, const std::filesystem::path& path);

}  // namespace postlens
