// Draws a CauseMap (the cause of the error in each pixel) as an image with a legend.
#pragma once

#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

/// Returns the sRGB colour that stands for a cause in images and in the viewer. "No cause" is grey, and the
/// last cause is white. The other colours are those of Okabe and Ito, which colour-blind readers can
/// distinguish.
[[nodiscard]] std::array<std::uint8_t, 3> cause_colour(ErrorCause cause);

/// Draws the reference in grey, and each pixel with an error in the colour of the cause of the error. A
/// legend below lists the causes and their fractions of the squared error. Returns scene-linear values for
/// `write_image`.
[[nodiscard]] Image cause_picture(const CauseMap& map, const Image& reference);

}  // namespace postlens
