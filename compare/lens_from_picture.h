// Estimates the lens of an image with depth of field, from the image and a sample file of the same view.
#pragma once

#include <string>
#include <vector>

#include "compare/lens_search/blur_search.h"
#include "lens/impulse.h"
#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// One minimum that the search found.
struct LensCandidate {
    LensPlace place;
    double error = 0;  ///< root mean square of the robust residuals, see `lens_from_picture`
};

struct LensFromPicture {
    LensCandidate best;
    double aperture_error_mm = 0, inverse_focus_error_per_m = 0;  ///< standard errors
    double correlation = 0;     ///< correlation of the errors of log aperture and 1/s, -1 to 1
    double pinhole_error = 0;   ///< error of the pinhole image, measured as `best.error` is
    double spread = 0;          ///< error of a constant image of the median tone, measured as `best.error` is
    double reliable_share = 0;  ///< fraction of the pixels that were compared, see `reliable_pixels`
    double largest_coc_px = 0;  ///< largest diameter over all pixels
    int pictures = 0;           ///< number of images that `focus` computed
    std::vector<LensCandidate> others;  ///< further minima that fit nearly as well, best first
};

struct LensFromPictureSettings {
    Impulse impulse;  ///< the aperture's shape
    int starts = 3;   ///< number of minima of the coarse search that are refined, 1 to 16
};

/// Fits the lens so that `focus` (scatter, 256 depths) reproduces the image, by least squares with
/// Levenberg-Marquardt. The parameters are log(F/n) and 1/s, for the focal length F, f-number n and focus
/// distance s; circles of confusion (CoC) are nearly linear in both parameters. The iterations start from the
/// best minima of `blur_search`, because the error can have one minimum with the focus in front of a sharp
/// surface and another with the focus behind it. A residual is the difference of `picture_tone` in a pixel.
/// Residuals above 0.02 count linearly [huber1964]. Each start is refined twice, over the `reliable_pixels`
/// of the lens with which the refinement begins. Derivatives are central differences over ±3 % of the
/// aperture and of the range of 1/depth. Smaller differences would be dominated by the steps in which `focus`
/// places its discs. Standard errors are computed from sums over blocks of pixels [white1980], because
/// residuals within a CoC are correlated. They do not include the systematic errors of `focus`
/// (docs/lens.md).
///
/// Throws Error(invalid_input) if the image has another size than the file, nonfinite values, constant
/// colour, no blur or another view. Also throws it if the image does not determine both aperture and focus,
/// or if no search converges. Throws Error(wrong_arguments) for orthographic files and settings out of range.
[[nodiscard]] LensFromPicture lens_from_picture(const SampleFileReader& file, const Image& picture,
                                                const LensFromPictureSettings& settings = {});

}  // namespace postlens
