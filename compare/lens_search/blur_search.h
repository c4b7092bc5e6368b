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
/// is always at least one minimum.
///
/// The blur model blurs each pixel of the pinhole image with a uniform disc, as if all neighbouring pixels
/// had the depth of this pixel. The disc has the diameter of the pixel's circle of confusion (CoC). The
/// residuals of about 60 diameters are computed once, so that testing a lens takes one look-up per pixel.
///
/// The apertures of the grid are those whose largest CoC is between 0.7 px and a quarter of the image width.
/// The inverse focus distances cover the range of recorded inverse depths, extended by half of that range at
/// either end. Images wider than 256 px are downscaled first.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
