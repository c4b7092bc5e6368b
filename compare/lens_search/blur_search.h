// Finds starting points for the search for a lens, by testing a grid of lenses with a simple model of blur.
#pragma once

#include <vector>

#include "compare/lens_search/recorded_depths.h"
#include "pictures/image.h"
#include "records/sample_header.h"

namespace postlens {

/// The two parameters of a lens that determine its blur if the field of view does not change.
struct LensPlace {
    double aperture_mm = 0;          ///< F / n, > 0
    double inverse_focus_per_m = 0;  ///< 1 / s, 0 or more
};

struct RoughMatch {
    LensPlace place;
    double error = 0;  ///< root mean square of `robust` residuals (see picture_tone.h)
};

/// Returns the local minima of the error over a grid of about 4,000 lenses, smallest error first; at least
/// one. The error is that of a simple model of blur: each pixel of the pinhole image is blurred by a uniform
/// disc with the diameter of its circle of confusion (CoC), as if all its neighbours had its depth. The
/// residuals of about 60 diameters are computed once, so that a lens costs one look-up per pixel. The
/// apertures of the grid have a largest CoC of 0.7 px to a quarter of the image's width. Its inverse focus
/// distances cover the range of recorded inverse depths, extended by half of that range at either end. Images
/// wider than 256 px are reduced first.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
