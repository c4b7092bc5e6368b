// `view --export`: one page for mail and lessons, which needs neither postlens nor a server.
#pragma once

#include <string>

#include "apps/command.h"

namespace postlens {

struct ViewExportOptions {
    std::string input, output;
    double most_mb = 10;  ///< 1e6 bytes
};

/// Writes a page with a stack of JPEG pictures, focus distances by f-numbers, and a map of depths to click
/// on: nine distances that lie evenly in what the frame shows, at the f-number of the file and two and four
/// times that. Pictures become fewer, and then smaller, until the page is no larger than `most_mb`; the page
/// and the result say what it could not hold. Throws Error(wrong_arguments) where it cannot hold anything.
[[nodiscard]] CommandResult export_view(const ViewExportOptions& options);

}  // namespace postlens
