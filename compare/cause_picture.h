// The map of why pixels are wrong, as a picture with its legend.
#pragma once

#include "planner/error_causes.h"
#include "records/image.h"

namespace postlens {

/// Every wrong pixel in the colour of its cause over the grey reference; below, the colours' names with their
/// shares of the squared error. Scene-linear, for `write_image`. Colours are told apart by the colour-blind.
[[nodiscard]] Image cause_picture(const CauseMap& causes, const Image& reference);

}  // namespace postlens
