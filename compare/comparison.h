// Computes all results of `postlens compare`: the errors of an image against a reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "compare/metrics/flip.h"
#include "compare/metrics/noise_floor.h"
#include "compare/metrics/pixel_errors.h"
#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// The images to compare. All must have the same size.
struct CompareInput {
    Image image, reference;
    /// an image without blur; it shows which pixels lens or shutter blur affects
    std::optional<Image> pinhole;
    /// an independent render with the same settings as `reference`
    std::optional<Image> second_reference;
    std::optional<double> flip_white_luminance;  ///< see `flip_exposures`
};

/// Errors over a set of pixels. An error is NaN if it is undefined, for example if the set is empty.
struct Figures {
    PixelErrors errors;
    double ssim = 0;      ///< mean over the pixels that have a value; see `ssim_map`
    double flip_ldr = 0;  ///< mean over all pixels
    double flip_hdr = 0;  ///< mean over all pixels
};

/// Numbers of pixels with a NaN or infinity in any channel.
struct NonfiniteCounts {
    std::size_t image = 0, reference = 0, pinhole = 0, second_reference = 0;
    std::size_t image_only = 0;  ///< in `image` only, where the reference is finite
    std::size_t any = 0;         ///< in `image` or `reference`; no error counts these pixels
};

struct Comparison {
    int width = 0, height = 0;
    bool identical = false;     ///< the bits of image and reference are equal
    bool within_range = false;  ///< no finite value is outside 0..1, so `flip` is LDR-FLIP
    /// Fraction of the pixels with a value outside 0..1 in either image. PSNR and SSIM clamp these values.
    double clipped_share = 0;
    NonfiniteCounts nonfinite;
    Figures whole;
    FlipExposures exposures;
    // Set only if a pinhole image is given.
    std::optional<double> affected_share;
    std::optional<Figures> affected;
    std::optional<PixelErrors> pinhole, pinhole_affected;  ///< errors of the pinhole image
    // The values below are set only if the tested image is compared with two references. The noise is
    // measured from the difference between the references. So it cannot be measured if
    // `references_are_equal`. `image_is_a_reference` is true if the tested image equals one of them.
    bool image_is_a_reference = false, references_are_equal = false;
    std::optional<NoiseFloor> noise, affected_noise;

    [[nodiscard]] double flip(const Figures& f) const { return within_range ? f.flip_ldr : f.flip_hdr; }
};

/// Throws Error(invalid_input) if the sizes of the images differ.
[[nodiscard]] Comparison compare_pictures(CompareInput input);

/// Approximate memory, in bytes, of compare_pictures for `pictures` images of this size.
[[nodiscard]] std::uint64_t comparison_bytes(ImageSize size, int pictures);

/// Limits on the errors of the whole frame.
struct CompareLimits {
    std::optional<double> least_psnr_db, greatest_relmse, greatest_flip;
};

/// Returns one line of text per limit that is not met. If any limit is set, NaNs or infinities also add a
/// line, unless the reference has them at the same pixels.
[[nodiscard]] std::vector<std::string> failed_limits(const Comparison& comparison,
                                                     const CompareLimits& limits);

}  // namespace postlens
