// Images of the recorded instants, for pixels over which nothing moves.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/groups/band_surfaces.h"
#include "pictures/image.h"

namespace postlens {

/// Per pixel of the frame: 1 if a corner of the pixel shows an object of the sorted ids, else 0. Also 0 in
/// bands that are not in memory.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Sets the pixels over which nothing moves (not `touched`) to the mean of the images of all recorded
/// instants, weighted by their `shares` of the exposure, because shadows and lights may move over static
/// surfaces. An instant is left out in pixels where an object of `elsewhere` hides the static surface at that
/// instant; these are sorted ids of objects whose blur is drawn separately. If all instants are left out, the
/// pixel of `image` stays.
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
