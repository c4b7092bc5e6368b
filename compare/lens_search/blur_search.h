// Finds starting points for fitting a lens, by testing a grid of lenses.
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

/// Tests a grid of about 4,000 lenses and returns the local minima of the error, at least one, smallest
/// first.
///
/// The pinhole image is blurred with uniform discs, as if neighbouring pixels had the same depth. Images
/// wider than 256 px are downscaled first.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
