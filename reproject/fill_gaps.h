// Fills pixels without a colour from their neighbours.
#pragma once

#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Replaces the colours of pixels whose weight is 0, by pull-push interpolation [gortler1996, sec. 3.5]. In
/// an image pyramid, each level is the weighted mean of the next finer level. A pixel of weight 0 gets its
/// colour from the finest level that has a weight above 0 there. All other pixels keep their colours. If all
/// weights are 0, the image becomes black.
void fill_gaps(Image& image, const std::vector<float>& weight);

}  // namespace postlens
