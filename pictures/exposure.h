// Exposure of images. In memory, the value 1 is white; .exr files store scene-linear radiance
// (docs/exposure.md).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Largest absolute exposure in options, headers and images, stops. A float has a larger range: 126 stops
/// above and below 1.
inline constexpr double most_exposure_stops = 100;

/// Returns 2^stops, the factor that converts radiance to values relative to white. Exactly 1 for 0 stops.
[[nodiscard]] double exposure_gain(double stops);

/// Returns the exposure -log2(v95), stops, which makes v95 white. v95 is the 95th percentile (nearest rank)
/// of those `values` that are finite and greater than 0. Returns 0 if there are no such values. Clamped to
/// +-most_exposure_stops. Reorders `values`.
[[nodiscard]] double auto_exposure_of(std::span<double> values);

/// Automatic exposure of an image, from the largest channel of each pixel. Computed from radiance, so the
/// image's own exposure has no influence. If that exposure is unknown, values count as radiance.
[[nodiscard]] double auto_exposure_of(const Image& image);

/// Changes the exposure of an image. Does nothing if the image's own exposure is unknown.
void set_exposure(Image& image, double stops);

struct ExposureWarning {
    double share = 0;  ///< share of the pixels above white; 1 for an image that is too dark
    std::string text;
};
/// Warns about an image that is written as PNG, TIFF or JPEG and is too bright or too dark. Too bright: more
/// than a fifth of the pixels have a channel above white. Too dark: every pixel is below 1/255 of white, but
/// some pixels are not black. The text suggests the exposure from auto_exposure_of.
[[nodiscard]] std::optional<ExposureWarning> exposure_warning(const Image& image,
                                                              const std::optional<Crop>& crop);

/// Reads the exposure, stops, from a text in a file's header. Throws Error(invalid_input), which names the
/// `file`.
[[nodiscard]] double stops_of_text(const std::string& text, const std::string& file);

}  // namespace postlens
