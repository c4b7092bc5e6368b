// Exposure of images. In memory, the value 1 is white. In .exr files, values are scene-linear radiance
// (docs/exposure.md).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Largest absolute exposure that options, headers and images may have, in stops. Floats have room for 126
/// stops above and below 1.
inline constexpr double most_exposure_stops = 100;

/// Returns 2^stops. Radiance multiplied by this factor gives the values of an image, in which 1 is white. The
/// factor for 0 stops is exactly 1.
[[nodiscard]] double exposure_gain(double stops);

/// Returns the exposure, in stops, that makes the 95th percentile of the values white. The percentile is that
/// of the finite values above 0. Returns 0 if there are no such values. The result is clamped to
/// +-most_exposure_stops. Reorders `values`.
[[nodiscard]] double auto_exposure_of(std::span<double> values);

/// Returns the automatic exposure of an image, computed from the largest channel of each pixel. The result
/// does not depend on the exposure that the image already has. If the exposure of the image is unknown, the
/// values of the image are treated as radiance.
[[nodiscard]] double auto_exposure_of(const Image& image);

/// Changes the exposure of an image, unless the image's own exposure is unknown.
void set_exposure(Image& image, double stops);

struct ExposureWarning {
    double share = 0;  ///< fraction of the pixels above white; 1 for an image that is too dark
    std::string text;
};
/// Warns if an image to be written as PNG, TIFF or JPEG is too bright or too dark. It is too bright if more
/// than a fifth of its pixels have a channel above white. It is too dark if all pixels are below 1/255 of
/// white and some are not black. The warning suggests the exposure of auto_exposure_of.
[[nodiscard]] std::optional<ExposureWarning> exposure_warning(const Image& image,
                                                              const std::optional<Crop>& crop);

/// Reads an exposure, in stops, from a text in the header of `file`. Throws Error(invalid_input), which names
/// the file.
[[nodiscard]] double stops_of_text(const std::string& text, const std::string& file);

}  // namespace postlens
