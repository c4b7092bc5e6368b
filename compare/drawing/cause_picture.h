// Image of a CauseMap (why pixels are wrong), with a legend.
#pragma once

#include "pictures/image.h"
#include "planner/error_causes.h"

namespace postlens {

/// Shows each wrong pixel in the colour of its cause, over the reference in grey. A legend below names the
/// causes with their shares of the squared error. Scene-linear, for `write_image`. Colour-blind readers can
/// distinguish the colours.
[[nodiscard]] Image cause_picture(const CauseMap& causes, const Image& reference);

}  // namespace postlens
