// Finds the colours of another program's image among the layers of its file.
#pragma once

#include <string>

#include "pictures/foreign/foreign_channels.h"

namespace postlens {

/// Sets the part, the layer and the names of the colours as find_foreign_channels states. `asked`:
/// ForeignChoice::layer. Throws Error(invalid_input) if no layer has colours.
void find_colours(const ForeignFile& file, const std::string& asked, ForeignChannels& out);

}  // namespace postlens
