// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Marks each pixel that directly shows an object of `ids` (sorted), or whose right, lower or lower right
/// neighbour does. Pixels in bands of rows that are not in memory get 0.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Replaces each pixel over which nothing moves (`touched` is 0) by its mean over all recorded instants,
/// because shadows and lights may change.
/// - `shares`: weights of the instants
/// - `elsewhere`: sorted ids of moving objects; the mean leaves out instants at which the pixel shows one of
///   these objects
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
