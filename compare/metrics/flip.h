// FLIP error of two images: the difference that a person sees when flipping between them.
#pragma once

#include <optional>
#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// Pixels per degree of visual angle that FLIP assumes: a display 0.7 m and 3840 px wide, seen from 0.7 m
/// [andersson2020, sec. 4].
inline constexpr double flip_pixels_per_degree = 3840 * 3.14159265358979323846 / 180;

/// LDR-FLIP [andersson2020]: one error per pixel, 0..1. Scene-linear values are clamped to 0..1. Beyond the
/// border the nearest pixel is repeated. Where `usable` is 0, both images count as black.
[[nodiscard]] std::vector<float> flip_map(const Image& reference, const Image& test, const PixelMask& usable);

/// Exposures at which HDR-FLIP compares the images: `count` of them, evenly spaced from `start` to `stop`, in
/// stops.
struct FlipExposures {
    double start = 0, stop = 0;
    int count = 1;
};

/// Exposures of HDR-FLIP for a reference [andersson2021, sec. 3]. The tone curve maps the reference's
/// greatest luminance to 0.85 at `start`, and its median luminance to 0.85 at `stop`; count = max(2,
/// ceil(stop - start)). If the median is 0, for which the paper's `stop` is infinite, the median of the
/// pixels above 0 replaces it. A black reference gives one exposure of 0 stops. `stop` is at most 30 stops
/// above `start`. `white_luminance` (above 0) replaces the greatest luminance; middle grey, 0.18, then
/// replaces the median.
[[nodiscard]] FlipExposures flip_exposures(const Image& reference, const PixelMask& usable,
                                           std::optional<double> white_luminance = std::nullopt);

/// HDR-FLIP [andersson2021]: one error per pixel, 0..1, the greatest of its LDR-FLIP errors over all
/// exposures. At each exposure a tone curve (the ACES approximation of [narkowicz2016]) is applied to both
/// images.
[[nodiscard]] std::vector<float> hdr_flip_map(const Image& reference, const Image& test,
                                              const PixelMask& usable, const FlipExposures& exposures);

}  // namespace postlens
