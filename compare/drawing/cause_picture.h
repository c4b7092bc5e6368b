// Draws a CauseMap (the cause of the error in each pixel) as an image with a legend.
#pragma once

#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

/// Returns the sRGB colour in which images and the viewer show a cause. Pixels without a cause are grey. The
/// colours are those of Okabe and Ito, which colour-blind readers can distinguish. The last cause is white.
[[nodiscard]] std::array<std::uint8_t, 3> cause_colour(ErrorCause cause);

/// Draws the reference in grey, and each pixel with an error in the colour of the cause of the error. A
/// legend below lists the causes and their fractions of the squared error. Returns scene-linear values for
/// `write_image`.
[[nodiscard]] Image cause_picture(const CauseMap& map, const Image& reference);

}  // namespace postlens
