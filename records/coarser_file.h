// A sample file of the same frame with fewer pixels, for quick previews.
#pragma once

#include <cstdint>
#include <filesystem>

#include "records/sample_file.h"

namespace postlens {

/// Writes a sample file whose pixels are `by` times as wide and as high as those of the file `fine`. It has
/// the samples of all layers and instants at every by-th pixel corner in both directions, and no subdivision.
/// Rows and columns that do not fill a wider pixel are left out at the right, at the bottom, and in the
/// overscan. Returns the number of records. Throws Error(wrong_arguments) if no pixel is left, and the errors
/// of reader and writer.
std::uint64_t write_coarser_file(const std::filesystem::path& fine, Damage damage, int by,
                                 const std::filesystem::path& coarse);

}  // namespace postlens
