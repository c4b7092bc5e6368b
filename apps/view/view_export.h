// `view --export` writes the viewer as one HTML page, which needs neither postlens nor a server.
#pragma once

#include <string>

#include "apps/command.h"

namespace postlens {

struct ViewExportOptions {
    std::string input, output;
    double most_mb = 10;  ///< greatest size of the page, in units of 1e6 bytes
};

/// Writes a page with JPEG images for a grid of focus distances and f-numbers, and a depth map that
/// the user clicks on. The nine focus distances are quantiles of the frame's depths. The f-numbers are
/// 1, 2 and 4 times the file's. The number of images, and then their size, is reduced until the page
/// is at most `most_mb`; page and result say what was left out. Throws Error(wrong_arguments) if not
/// even the smallest page fits.
[[nodiscard]] CommandResult export_view(const ViewExportOptions& options);

}  // namespace postlens
