// Exposure of images. In memory, 1 is white; files hold scene-linear radiance (docs/exposure.md).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Largest absolute exposure in options, headers and images, stops. A float has 126 octaves on both sides
/// of 1.
inline constexpr double most_exposure_stops = 100;

/// 2^stops, the factor from radiance to values relative to white. Exactly 1 for 0 stops.
[[nodiscard]] double exposure_gain(double stops);

/// Exposure -log2(v95), stops, where v95 is the 95th percentile by nearest rank of the `values` that are
/// finite and more than 0; 0 if there are none. Clamped to +-most_exposure_stops. Reorders `values`.
[[nodiscard]] double auto_exposure_of(std::span<double> values);

/// Automatic exposure from the largest channel of each pixel's radiance, so that the image's own exposure
/// does not matter. Values of an image with unknown exposure are taken as radiance.
[[nodiscard]] double auto_exposure_of(const Image& image);

/// Changes the exposure of an image. Does nothing if its own exposure is not known.
void set_exposure(Image& image, double stops);

struct ExposureWarning {
    double share = 0;  ///< share of the pixels above white; 1 for an image that is too dark
    std::string text;
};
/// Warning for an image that is written as PNG, TIFF or JPEG, if more than a fifth of its pixels have a
/// channel above white, or if all pixels are below 1/255 of white but not all are black. The text suggests
/// the exposure from auto_exposure_of.
[[nodiscard]] std::optional<ExposureWarning> exposure_warning(const Image& image,
                                                              const std::optional<Crop>& crop);

/// Reads the exposure, stops, from a text in a file's header. Throws Error(invalid_input), naming the `file`.
[[nodiscard]] double stops_of_text(const std::string& text, const std::string& file);

}  // namespace postlens
