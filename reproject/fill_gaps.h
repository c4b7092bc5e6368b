// Colours for pixels that nothing is known of.
#pragma once

#include <vector>

#include "records/image.h"

namespace postlens {

/// Gives the pixels of weight 0 the colours of those around them: each level of a pyramid averages what is
/// known by weight, and every gap takes the finest level that knows something [gortler1996, sec. 3.5
/// "pull-push"]. Pixels of weight above 0 keep their colour. With no weight at all the picture becomes black.
void fill_gaps(Image& image, const std::vector<float>& weight);

}  // namespace postlens
