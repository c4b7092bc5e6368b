// How far off a guess at a pixel's colour is that goes by what is around it.
#pragma once

#include <vector>

#include "records/image.h"

namespace postlens {

/// By pixel: the variance (mean of the channels, encoded values) of the picture within `radius_px` to each
/// side. Same bits for any number of threads.
[[nodiscard]] std::vector<float> local_contrast(const Image& image, int radius_px = 32);

/// Expected squared error, encoded values, of a pixel of whose light so much is unknown and filled in with
/// what is around it, which varies so much.
[[nodiscard]] inline double filled_in_error(double unknown_share, double variance) {
    return unknown_share * unknown_share * variance;
}
/// The same of one that shows so much light (encoded) which belongs elsewhere, however far: some of it is
/// right where it is.
[[nodiscard]] inline double misplaced_error(double light) {
    return light * light / 4;
}

}  // namespace postlens
