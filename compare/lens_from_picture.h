// Estimates the lens that blurred an image, from a sample file of the same view.
#pragma once

#include <string>
#include <vector>

#include "compare/lens_search/blur_search.h"
#include "lens/impulse.h"
#include "pictures/image.h"
#include "records/sample_file.h"

namespace postlens {

/// A minimum of the error that the search found.
struct LensCandidate {
    LensPlace place;
    double error = 0;  ///< root mean square of the robust residuals; see `lens_from_picture`
};

struct LensFromPicture {
    LensCandidate best;
    double aperture_error_mm = 0, inverse_focus_error_per_m = 0;  ///< standard errors
    double correlation = 0;     ///< correlation of the errors of log aperture and 1/s, -1 to 1
    double pinhole_error = 0;   ///< error of the pinhole image, measured like `best.error`
    double spread = 0;          ///< error of a constant image of the median tone, measured like `best.error`
    double reliable_share = 0;  ///< fraction of the pixels that were compared; see `reliable_pixels`
    double largest_coc_px = 0;  ///< largest diameter of a circle of confusion
    int pictures = 0;           ///< number of images that `focus` computed
    std::vector<LensCandidate> others;  ///< further lenses that fit nearly as well, best first
};

struct LensFromPictureSettings {
    Impulse impulse;  ///< the shape of the aperture
    int starts = 3;   ///< number of rough matches that are refined, 1 to 16
};

/// Finds the lens with which `focus` (method scatter, 256 depths) reproduces the image. The lens is fitted by
/// least squares with the Levenberg-Marquardt method. The parameters are log(F/n) and 1/s, where F is the
/// focal length, n the f-number and s the focus distance. A residual is the difference between the
/// `picture_tone` of both images in a pixel. Residuals above 0.02 count linearly instead of quadratically
/// [huber1964].
///
/// The error can have one minimum with the focus in front of a sharp surface and another with the focus
/// behind it. The fit therefore starts from several minima found by `blur_search`. From each start it is run
/// twice. Each run uses the `reliable_pixels` of the lens with which the run begins. Derivatives are central
/// differences over ±3 % of the aperture and of the range of 1/depth.
///
/// Standard errors are computed from sums over blocks of pixels [white1980], because residuals within a
/// circle of confusion are correlated. They do not include the systematic errors of `focus` (docs/lens.md).
///
/// Throws Error(invalid_input) if the image has a size other than that of the file, shows another view,
/// contains values that are not finite, or shows no blur. Also throws this error if the image does not
/// determine both aperture and focus, or if no search converges. Throws Error(wrong_arguments) for
/// orthographic files and settings out of range.
[[nodiscard]] LensFromPicture lens_from_picture(const SampleFileReader& file, const Image& picture,
                                                const LensFromPictureSettings& settings = {});

}  // namespace postlens
