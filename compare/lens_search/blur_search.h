// Starting points for the search for a lens: a grid of lenses, tested with a rough model of blur.
#pragma once

#include <vector>

#include "compare/lens_search/recorded_depths.h"
#include "pictures/image.h"
#include "records/sample_header.h"

namespace postlens {

/// The two parameters of a lens that determine its blur while the field of view stays the same.
struct LensPlace {
    double aperture_mm = 0;          ///< F / n, > 0
    double inverse_focus_per_m = 0;  ///< 1 / s, 0 or more
};

struct RoughMatch {
    LensPlace place;
    double error = 0;  ///< root mean square of `robust` residuals (see picture_tone.h)
};

/// Local minima of the error of a rough model of blur over a grid of about 4,000 lenses, smallest error
/// first; at least one. The model blurs each pixel of the pinhole image with a uniform disc of the pixel's
/// own circle of confusion (CoC), as if all its neighbours lay at its depth. The residuals of some 60
/// diameters are computed once, so that a lens costs one look-up per pixel. The grid covers apertures whose
/// largest CoC is 0.7 px to a quarter of the image's width. It covers focus distances s whose 1/s lies in the
/// range of recorded inverse depths or beyond by up to half of that range at either end. Images wider than
/// 256 px are reduced first.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
