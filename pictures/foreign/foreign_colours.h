// Finds the colour channels of another program's image.
#pragma once

#include <string>

#include "pictures/foreign/foreign_channels.h"

namespace postlens {

/// Finds the colour channels of the layer `asked`, which the user named. find_foreign_channels() states the
/// rules by which a layer is selected. Sets the file part, the layer and the colour channels of `out`. Throws
/// Error(invalid_input) if no layer has colours.
void find_colours(const ForeignFile& file, const std::string& asked, ForeignChannels& out);

}  // namespace postlens
