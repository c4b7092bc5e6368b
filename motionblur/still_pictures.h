// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Returns 1 for each pixel whose samples directly (not by reflection) show an object of `ids`, a sorted
/// list, and 0 for the others. Pixels share the samples at their corners, so the pixels to the left, above
/// and above left of such a pixel also get 1. Pixels in bands of rows that are not in memory get 0.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Blurs the changes of shadows and lights in pixels over which nothing moves (`touched` is 0). Each such
/// pixel is replaced by the mean of its colours at the recorded instants.
/// - `shares`: weights of the instants in the mean
/// - `elsewhere`: sorted ids of moving objects; an instant at which the pixel shows one of them is left out
///   of the mean
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
