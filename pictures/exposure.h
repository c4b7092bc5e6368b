// Exposure of images. In memory, 1 is white. Files in the format .exr store scene-linear radiance
// (docs/exposure.md).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Largest absolute value of an exposure, in stops. It lies within the range of floats, about 126 stops above
/// and below 1.
inline constexpr double most_exposure_stops = 100;

/// Returns 2^stops, the factor from radiance to image values, in which 1 is white. It is exactly 1 for 0
/// stops.
[[nodiscard]] double exposure_gain(double stops);

/// Returns the exposure, in stops, at which the 95th percentile of the finite positive values becomes white.
/// Returns 0 if there are none. The result is clamped to +-most_exposure_stops. Reorders `values`.
[[nodiscard]] double auto_exposure_of(std::span<double> values);

/// Returns the automatic exposure of an image, in stops. It is computed from the radiance in the largest
/// colour channel of each pixel. If Image::exposure_stops, the current exposure of the pixels, is unknown,
/// they are treated as radiance.
[[nodiscard]] double auto_exposure_of(const Image& image);

/// Changes the exposure of an image to `stops`, by scaling its colours. The factor depends on its current
/// exposure, Image::exposure_stops. If this is unknown, the image remains unchanged.
void set_exposure(Image& image, double stops);

struct ExposureWarning {
    double share = 0;  ///< fraction of the pixels above white; 1 for an image that is too dark
    std::string text;
};
/// Returns a warning if an 8-bit or 16-bit version of the image would be too bright or too dark. Its text
/// suggests the exposure of auto_exposure_of.
/// - too bright: more than a fifth of the pixels have a channel above white
/// - too dark: all pixels are below 1/255 of white, but not all are black
[[nodiscard]] std::optional<ExposureWarning> exposure_warning(const Image& image,
                                                              const std::optional<Crop>& crop);

/// Parses an exposure in stops from the header of `file`. Throws Error(invalid_input), with the name of the
/// file, if the text is invalid.
[[nodiscard]] double stops_of_text(const std::string& text, const std::string& file);

}  // namespace postlens
