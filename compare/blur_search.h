// Where to begin the search for a lens: all lenses tried at once on a rough model of blur.
#pragma once

#include <vector>

#include "compare/recorded_depths.h"
#include "records/image.h"
#include "records/sample_header.h"

namespace postlens {

/// A lens as what a picture with its view kept tells of it.
struct LensPlace {
    double aperture_mm = 0;          ///< F / n, > 0
    double inverse_focus_per_m = 0;  ///< 1 / s, 0 or more
};

struct RoughMatch {
    LensPlace place;
    double error = 0;  ///< root mean square of `robust` residuals (see picture_tone.h)
};

/// The lenses at which the rough model is better than at all its neighbours, best first, at least one. The
/// model: each pixel of the pinhole picture blurred evenly by its own CoC, as if all around it lay at its
/// depth; made once for each of some 60 diameters, so that a lens costs a look-up for each pixel and 4,000
/// are tried: apertures whose largest CoC is 0.7 px to a quarter of the picture, focus distances over the
/// depths seen and half of their range beyond, in 1/s. Pictures of more than 256 px are reduced.
[[nodiscard]] std::vector<RoughMatch> blur_search(const Image& pinhole, const Image& picture,
                                                  const RecordedDepths& depths, const SampleHeader& header);

}  // namespace postlens
