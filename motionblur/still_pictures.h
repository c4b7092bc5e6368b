// Images of the recorded instants, used for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// For each pixel of the frame: 1 if a corner of the pixel shows an object of `ids` (sorted), otherwise 0.
/// Pixels in bands that are not in memory get 0.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Sets each pixel over which nothing moves (`touched` is 0) to a mean of the images of all recorded
/// instants, because shadows and lights may move over static surfaces. `shares`: weights of the instants,
/// equal to their shares of the exposure. `elsewhere`: sorted ids of objects whose blur is drawn separately.
/// An instant is left out in pixels where such an object hides the static surface at this instant. If all
/// instants are left out, the pixel does not change.
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
