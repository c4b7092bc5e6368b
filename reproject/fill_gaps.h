// Fills pixels without a colour from their neighbours.
#pragma once

#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Fills the holes of an image (pixels of weight 0) by pull-push interpolation on an image pyramid
/// [gortler1996, sec. 3.5]. If all weights are 0, the image becomes black.
void fill_gaps(Image& image, const std::vector<float>& weight);

}  // namespace postlens
