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

/// Tests a grid of about 4,000 lenses and returns the local minima of the error, smallest error first. There
/// is at least one.
///
/// The blur model blurs each pixel of the pinhole image with a uniform disc, as if its neighbours had the
/// same depth. The grid covers largest blur diameters from 0.7 px to a quarter of the image width. Its
/// inverse focus distances extend the recorded range by half at either end. Images wider than 256 px are
/// downscaled first.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
