// Draws a CauseMap, the cause of the error in each pixel, as an image with a legend.
#pragma once

#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

/// Returns the sRGB colour that stands for a cause of error in images and in the viewer. The colours are
/// those of Okabe and Ito, because colour-blind readers can distinguish them.
[[nodiscard]] std::array<std::uint8_t, 3> cause_colour(ErrorCause cause);

/// Draws where an image is wrong, over the grey reference. The colour of a pixel stands for the cause of its
/// error. Returns scene-linear values for `write_image`.
[[nodiscard]] Image cause_picture(const CauseMap& map, const Image& reference);

}  // namespace postlens
