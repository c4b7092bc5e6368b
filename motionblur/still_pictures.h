// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Returns 1 for each pixel whose samples directly (not by reflection) show an object of `ids`, a sorted
/// list, and 0 for the others. The pixels to the left, above and above left of such a pixel also get 1,
/// because they share the samples at its corners. Pixels in bands of rows that are not in memory get 0.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Blurs changes of shadows and light in pixels over which nothing moves (`touched` is 0). Each of these
/// pixels is replaced by the mean of its colours at the recorded instants.
/// - `shares`: weights of the instants in the mean
/// - `elsewhere`: sorted ids of moving objects; instants at which a pixel shows one of them are left out of
///   its mean
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
