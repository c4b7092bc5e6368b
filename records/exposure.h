// Exposure: in memory 1 is white; files hold scene-linear radiance (docs/exposure.md).
#pragma once

#include <optional>
#include <span>
#include <string>

#include "records/image.h"

namespace postlens {

/// Stops that options, headers and images may hold, either way: a float has 126 octaves on both sides of 1.
inline constexpr double most_exposure_stops = 100;

/// 2^stops: radiance times this is relative to white. Exactly 1 for 0.
[[nodiscard]] double exposure_gain(double stops);

/// -log2(v95) stops, where v95 is the 95th percentile by nearest rank of those `values` that are finite and
/// more than 0; 0 where there is none. Within +-most_exposure_stops. `values` is reordered.
[[nodiscard]] double auto_exposure_of(std::span<double> values);

/// The same for the largest channel of each pixel of the image's radiance, so that the image's own exposure
/// does not matter. An image whose exposure is not known is taken as radiance.
[[nodiscard]] double auto_exposure_of(const Image& image);

/// Brings an image to another exposure; nothing where its own is not known.
void set_exposure(Image& image, double stops);

struct ExposureWarning {
    double share = 0;  ///< of the pixels that are beyond white; 1 for what is too dark
    std::string text;
};
/// Of an image as a PNG, TIFF or JPEG shows it: where more than a fifth of the pixels have a channel above
/// white, or every pixel is below 1/255 of white though not all are black. Names the exposure that
/// auto_exposure_of finds.
[[nodiscard]] std::optional<ExposureWarning> exposure_warning(const Image& image,
                                                              const std::optional<Crop>& crop);

/// The stops that a text in a file's header says. Throws Error(invalid_input), naming the `file`.
[[nodiscard]] double stops_of_text(const std::string& text, const std::string& file);

}  // namespace postlens
