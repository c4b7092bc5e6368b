// The FLIP difference of two pictures: how large an error a person would see who flips between them.
#pragma once

#include <optional>
#include <vector>

#include "compare/pixel_mask.h"
#include "records/image.h"

namespace postlens {

/// Pixels per degree of visual angle that FLIP assumes: a display 0.7 m and 3840 px wide, seen from 0.7 m
/// [andersson2020, sec. 4].
inline constexpr double flip_pixels_per_degree = 3840 * 3.14159265358979323846 / 180;

/// LDR-FLIP [andersson2020], one error 0..1 a pixel. Scene-linear values are clamped to 0..1; beyond the
/// border the nearest pixel is repeated; where `usable` is 0 both pictures are taken as black.
[[nodiscard]] std::vector<float> flip_map(const Image& reference, const Image& test, const PixelMask& usable);

/// Exposures, in stops, at which HDR-FLIP looks at the pictures.
struct FlipExposures {
    double start = 0, stop = 0;
    int count = 1;
};

/// The exposures of HDR-FLIP for a reference [andersson2021, sec. 3]: at `start` its greatest luminance, at
/// `stop` its median luminance is mapped to 0.85 by the tone curve, and count = max(2, ceil(stop - start)).
/// Where the median is 0, the median of the pixels above 0 takes its place (the paper's would be infinite); a
/// reference without light gives one exposure of 0 stops. `stop` is at most 30 stops above `start`.
/// white_luminance, more than 0: instead of the reference's maximum, the median then being middle grey, 0.18.
[[nodiscard]] FlipExposures flip_exposures(const Image& reference, const PixelMask& usable,
                                           std::optional<double> white_luminance = std::nullopt);

/// HDR-FLIP [andersson2021]: at each exposure both pictures go through a tone curve (the ACES approximation
/// of [narkowicz2016]), and a pixel's error is the greatest of its LDR-FLIP errors.
[[nodiscard]] std::vector<float> hdr_flip_map(const Image& reference, const Image& test,
                                              const PixelMask& usable, const FlipExposures& exposures);

}  // namespace postlens
