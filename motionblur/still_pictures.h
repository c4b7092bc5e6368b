// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/band_surfaces.h"
#include "records/image.h"

namespace postlens {

/// 1 for each pixel of the frame in which a corner shows one of the ids (sorted); 0 for the others and in
/// bands that are not in memory.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Sets the pixels that are not `touched` to the mean of the images of all recorded instants, weighted by
/// their `shares` of the exposure: shadows and lights may move over static surfaces. An instant at which a
/// pixel shows one of `elsewhere` (sorted ids whose blur is drawn separately) does not count there, as it
/// hides the static surface. If no instant counts, the pixel of `image` stays.
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
