// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Marks each pixel whose samples directly show an object of `ids` (sorted). Also marks its left, upper and
/// upper left neighbours, which share samples with it. Pixels in bands of rows that are not in memory get 0.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Shadows and lights may change between the recorded instants. Replaces each pixel over which nothing moves
/// (`touched` is 0) by its mean over these instants.
/// - `shares`: weights of the instants
/// - `elsewhere`: sorted ids of moving objects; an instant at which the pixel shows one of them is left out
///   of the mean
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
