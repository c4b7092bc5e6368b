// Draws a CauseMap (the cause of the error in each pixel) as an image with a legend.
#pragma once

#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

/// Shows each pixel with an error in the colour of its cause, over the reference in grey. The legend below
/// lists the causes with their fractions of the squared error. The values are scene-linear, for
/// `write_image`. Colour-blind readers can distinguish the colours.
[[nodiscard]] Image cause_picture(const CauseMap& causes, const Image& reference);

}  // namespace postlens
