// How far off a guess at a pixel's colour is that goes by what is around it.
#pragma once

#include <vector>

#include "records/image.h"

namespace postlens {

/// By pixel: the variance (mean of the channels, encoded values) of the picture within `radius_px` to each
/// side. Same bits for any number of threads.
[[nodiscard]] std::vector<float> local_contrast(const Image& image, int radius_px = 32);

}  // namespace postlens
