// Draws a CauseMap (the cause of the error in each pixel) as an image with a legend.
#pragma once

#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

/// The colour, sRGB, in which images and the viewer show a cause: grey for none, then the palette of Okabe
/// and Ito, which colour-blind readers can distinguish, and white for the last cause.
[[nodiscard]] std::array<std::uint8_t, 3> cause_colour(ErrorCause cause);

/// Shows each pixel with an error in the colour of its cause, over the reference in grey. The legend below
/// lists the causes with their fractions of the squared error. The values are scene-linear, for
/// `write_image`.
[[nodiscard]] Image cause_picture(const CauseMap& map, const Image& reference);

}  // namespace postlens
