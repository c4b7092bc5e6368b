// Finds the colour channels of another program's image.
#pragma once

#include <string>

#include "pictures/foreign/foreign_channels.h"

namespace postlens {

/// Finds the colours in the layer `asked` by the rules of find_foreign_channels, and sets the part, the layer
/// and the colour channels of `out`. Throws Error(invalid_input) if no layer has colours.
void find_colours(const ForeignFile& file, const std::string& asked, ForeignChannels& out);

}  // namespace postlens
