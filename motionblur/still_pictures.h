// Images of the recorded instants. They are used for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Returns 1 for a pixel of the frame if an object of `ids` (sorted) is directly visible in it or in its
/// neighbours to the right and below, and otherwise 0. Pixels in bands that are not in memory get 0.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Replaces each pixel over which nothing moves (`touched` is 0) by a weighted mean of the images of all
/// recorded instants, because shadows and lights may move over static surfaces. `shares` contains the weight
/// of each instant, which is its share of the exposure.
///
/// `elsewhere` contains the sorted ids of objects whose blur is drawn separately. An instant does not count
/// in the mean of a pixel that shows such an object at this instant. If no instant counts, the pixel does not
/// change.
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
