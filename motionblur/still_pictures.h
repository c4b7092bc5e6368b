// Pictures of the recorded instants, for what does not move.
#pragma once

#include <cstdint>
#include <vector>

#include "motionblur/band_surfaces.h"
#include "records/image.h"

namespace postlens {

/// 1 for each pixel of the frame where one of its four corners shows one of the ids (sorted), 0 elsewhere and
/// in bands that are not in memory.
[[nodiscard]] std::vector<std::uint8_t> pixels_showing(const SampleHeader& header,
                                                       const std::vector<RecordBand>& bands,
                                                       const std::vector<std::uint32_t>& ids);

/// Where not `touched`, the mean over the recorded instants, by their `shares` of the exposure: shadows and
/// lights move over what stands still. An instant at which a pixel shows one of `elsewhere` (sorted ids whose
/// blur is drawn otherwise) says nothing of what stands there; where all do, `image` stays.
void blend_stills(const SampleFileReader& file, const std::vector<double>& shares,
                  const std::vector<std::uint32_t>& elsewhere, const std::vector<std::uint8_t>& touched,
                  Image& image);

}  // namespace postlens
