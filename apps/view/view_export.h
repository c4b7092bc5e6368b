// Writes the viewer as one HTML page (`view --export`), which needs neither postlens nor a server.
#pragma once

#include <string>

#include "apps/command.h"

namespace postlens {

struct ViewExportOptions {
    std::string input, output;
    double most_mb = 10;  ///< greatest size of the page, MB (1e6 bytes)
};

/// Writes a page with JPEG images for several focus distances and f-numbers, and a depth map for the user's
/// clicks. A page above `most_mb` gets fewer or smaller images. Throws Error(wrong_arguments) if even the
/// smallest page is too large.
[[nodiscard]] CommandResult export_view(const ViewExportOptions& options);

}  // namespace postlens
