// Which lens took this? From a picture with depth of field and the sample file of the same view.
#pragma once

#include <string>
#include <vector>

#include "compare/blur_search.h"
#include "lens/impulse.h"
#include "records/image.h"
#include "records/sample_file.h"

namespace postlens {

/// One place where the search came to rest.
struct LensCandidate {
    LensPlace place;
    double error = 0;  ///< root mean square of the robust residuals, see lens_from_picture
};

struct LensFromPicture {
    LensCandidate best;
    double aperture_error_mm = 0, inverse_focus_error_per_m = 0;  ///< standard errors
    double correlation = 0;             ///< of the errors of log aperture and 1/s, -1 to 1
    double pinhole_error = 0;           ///< as `best.error`, of the pinhole picture
    double spread = 0;                  ///< as `best.error`, of an even picture of the median
    double reliable_share = 0;          ///< of the pixels, that were looked at
    double largest_coc_px = 0;          ///< diameter, over all pixels
    int pictures = 0;                   ///< that were focused
    std::vector<LensCandidate> others;  ///< further minima that fit nearly as well, best first
};

struct LensFromPictureSettings {
    Impulse impulse;  ///< the aperture's shape
    int starts = 3;   ///< minima of the rough search that are looked at, 1 to 16
};

/// Least squares between `focus` (scatter, 256 depths) and the picture over log(F/n) and 1/s, in which CoCs
/// are close to linear, by Levenberg-Marquardt from the best places of `blur_search`, since the error has a
/// minimum on either side of what is sharp. A residual is a difference of `picture_tone`, beyond 0.02 counted
/// linearly [huber1964], over the `reliable_pixels` of the lens that the iteration began with, twice.
/// Derivatives are central differences over 3 % of the aperture and of the depths' range: less would show the
/// steps in which `focus` places its discs. Standard errors are those of sums over blocks of pixels
/// [white1980], since residuals are alike within a CoC; what `focus` gets wrong everywhere (docs/lens.md) is
/// not in them.
///
/// Throws Error(invalid_input), in words, where there is no answer: another size than the file's, values that
/// are not finite, an even picture, no blur, another view, aperture and focus that the picture does not tell
/// apart, a search that does not end; Error(wrong_arguments) for orthographic files and settings out of
/// range.
[[nodiscard]] LensFromPicture lens_from_picture(const SampleFileReader& file, const Image& picture,
                                                const LensFromPictureSettings& settings = {});

}  // namespace postlens
