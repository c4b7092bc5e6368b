// Everything `postlens compare` finds out about a picture, its reference and, if given, the pinhole picture
// and a second reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "compare/flip.h"
#include "compare/noise_floor.h"
#include "compare/pixel_errors.h"
#include "compare/pixel_mask.h"
#include "records/image.h"

namespace postlens {

/// All pictures have one size.
struct CompareInput {
    Image image, reference;
    std::optional<Image> pinhole;           ///< tells which pixels the lens or shutter affects
    std::optional<Image> second_reference;  ///< an independent render of what `reference` shows, equally good
    std::optional<double> flip_white_luminance;  ///< see `flip_exposures`
};

/// Figures of a set of pixels. NaN: there is none, for want of pixels.
struct Figures {
    PixelErrors errors;
    double ssim = 0;      ///< mean over the pixels that have a value, see `ssim_map`
    double flip_ldr = 0;  ///< mean
    double flip_hdr = 0;  ///< mean
};

/// Pixels with a NaN or an infinity in any channel.
struct NonfiniteCounts {
    std::size_t image = 0, reference = 0, pinhole = 0, second_reference = 0;
    std::size_t image_only = 0;  ///< of `image`, where the reference is finite
    std::size_t any = 0;         ///< in `image` or `reference`: these are left out of every figure
};

struct Comparison {
    int width = 0, height = 0;
    bool identical = false;     ///< image and reference hold the same bits
    bool within_range = false;  ///< both lie within 0..1 (finite values): `flip` is then the LDR one
    double clipped_share =
        0;  ///< of the pixels: a value of either outside 0..1, which PSNR and SSIM do not see
    NonfiniteCounts nonfinite;
    Figures whole;
    FlipExposures exposures;
    // With a pinhole picture:
    std::optional<double> affected_share;
    std::optional<Figures> affected;
    std::optional<PixelErrors> pinhole, pinhole_affected;  ///< errors of the pinhole picture
    // With a second reference:
    bool image_is_a_reference = false, references_are_equal = false;  ///< bit for bit: no noise to be had
    std::optional<NoiseFloor> noise, affected_noise;

    [[nodiscard]] double flip(const Figures& f) const { return within_range ? f.flip_ldr : f.flip_hdr; }
};

/// Throws Error(invalid_input) where sizes differ.
[[nodiscard]] Comparison compare_pictures(CompareInput input);

/// About how much memory that takes for `pictures` pictures of this size.
[[nodiscard]] std::uint64_t comparison_bytes(ImageSize size, int pictures);

/// What must hold for the whole frame.
struct CompareLimits {
    std::optional<double> least_psnr_db, greatest_relmse, greatest_flip;
};

/// One line for each limit that is not met. Where any is set, a picture with a NaN or an infinity where the
/// reference has none fails as well.
[[nodiscard]] std::vector<std::string> failed_limits(const Comparison& comparison,
                                                     const CompareLimits& limits);

}  // namespace postlens
