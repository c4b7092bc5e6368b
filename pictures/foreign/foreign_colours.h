// Finds the colour channels of another program's image.
#pragma once

#include <string>

#include "pictures/foreign/foreign_channels.h"

namespace postlens {

/// Finds the colours of the layer `asked`, a name from the user, by the rules of find_foreign_channels().
/// Sets the part, the layer and the colour channels of `out`. Throws Error(invalid_input) if no layer has
/// colours.
void find_colours(const ForeignFile& file, const std::string& asked, ForeignChannels& out);

}  // namespace postlens
