// Finds starting points for fitting a lens to an image, by testing a grid of apertures and focus distances.
#pragma once

#include <vector>

#include "compare/lens_search/recorded_depths.h"
#include "pictures/image.h"
#include "records/sample_header.h"

namespace postlens {

/// The two lens parameters that determine blur at a fixed field of view.
struct LensPlace {
    double aperture_mm = 0;          ///< F / n, > 0
    double inverse_focus_per_m = 0;  ///< 1 / s, 0 or more
};

struct RoughMatch {
    LensPlace place;
    double error = 0;  ///< root mean square of `robust` residuals (see picture_tone.h)
};

/// Blurs `pinhole` with about 4,000 lenses (a grid of apertures and focus distances), and compares the
/// results with `picture`. Returns the lenses at the local minima of the error, at least one, smallest error
/// first.
///
/// Blur is approximated by uniform discs, as if neighbouring pixels had the same depth. Images wider than 256
/// px are downscaled first.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
