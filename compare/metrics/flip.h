// FLIP error of two images: the difference that a person sees when flipping between them.
#pragma once

#include <optional>
#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// Pixels per degree of visual angle that FLIP assumes: 3840 px on 0.7 m, seen from 0.7 m [andersson2020,
/// sec. 4].
inline constexpr double flip_pixels_per_degree = 3840 * 3.14159265358979323846 / 180;

/// Computes LDR-FLIP [andersson2020]: one error per pixel, 0 to 1. Values are clamped to 0..1. Pixels beyond
/// the border repeat the nearest. Where `usable` is 0, images are black.
[[nodiscard]] std::vector<float> flip_map(const Image& reference, const Image& test, const PixelMask& usable);

/// HDR-FLIP compares the images at `count` exposures, evenly spaced from `start` to `stop`, in stops.
struct FlipExposures {
    double start = 0, stop = 0;
    int count = 1;
};

/// Returns the exposures at which HDR-FLIP compares images with `reference`, about one per stop
/// [andersson2021, sec. 3]. At the first exposure, `start`, the tone curve maps the greatest luminance of the
/// reference to 0.85. At the last exposure, `stop`, it maps the median luminance to 0.85.
/// - `white_luminance`: if given, the first exposure maps this luminance to 0.85, and the last maps the
///   luminance 0.18 to 0.85
[[nodiscard]] FlipExposures flip_exposures(const Image& reference, const PixelMask& usable,
                                           std::optional<double> white_luminance = std::nullopt);

/// Computes HDR-FLIP [andersson2021]: each pixel's greatest LDR-FLIP error over all exposures, 0 to 1. At
/// each exposure, both images pass the ACES tone curve of [narkowicz2016].
[[nodiscard]] std::vector<float> hdr_flip_map(const Image& reference, const Image& test,
                                              const PixelMask& usable, const FlipExposures& exposures);

}  // namespace postlens
