// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Per pixel of the frame: 1 if a corner of the pixel shows an object of `ids`, else 0. Pixels in bands that
/// are not in memory get 0. `ids` must be sorted.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Sets each pixel over which nothing moves (`touched` is 0) to the mean of the images of all recorded
/// instants, because shadows and lights may move over static surfaces. `shares`: weights of the instants,
/// which are their shares of the exposure. `elsewhere`: sorted ids of objects whose blur is drawn separately.
/// Where such an object hides the static surface at an instant, that instant is left out. If all instants are
/// left out, the pixel does not change.
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
