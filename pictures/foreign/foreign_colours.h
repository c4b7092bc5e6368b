// Finds the colour channels of another program's image.
#pragma once

#include <string>

#include "pictures/foreign/foreign_channels.h"

namespace postlens {

/// Sets the part, the layer and the channel names of the colours. find_foreign_channels describes the rules.
/// `asked` is ForeignChoice::layer. Throws Error(invalid_input) if no layer has colours.
void find_colours(const ForeignFile& file, const std::string& asked, ForeignChannels& out);

}  // namespace postlens
