// Fills pixels without a colour from their neighbours.
#pragma once

#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Pull-push interpolation [gortler1996, sec. 3.5]: each level of an image pyramid is the weighted mean of
/// the finer one, and a pixel of weight 0 gets its colour from the finest level with a weight above 0. Pixels
/// of weight above 0 keep their colour. If all weights are 0, the image becomes black.
void fill_gaps(Image& image, const std::vector<float>& weight);

}  // namespace postlens
