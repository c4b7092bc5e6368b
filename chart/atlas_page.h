// The atlas of failure as documents.
#pragma once

#include <filesystem>
#include <string>

#include "chart/atlas_folder.h"

namespace postlens {

/// Markdown: the introduction, a table of all cases, then by cause each case with its strip (a link to
/// atlas_strip), sentences and figures.
[[nodiscard]] std::string atlas_markdown(const AtlasRun& run);

/// The same as one HTML page with the pictures inside; `folder` is what run_atlas has filled. Throws
/// Error(invalid_input) where a picture cannot be read.
[[nodiscard]] std::string atlas_html(const AtlasRun& run, const std::filesystem::path& folder);

}  // namespace postlens
