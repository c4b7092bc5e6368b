// Writes the atlas of failures as Markdown and as HTML.
#pragma once

#include <filesystem>
#include <string>

#include "chart/atlas/atlas_folder.h"

namespace postlens {

/// Returns a Markdown page about the atlas, a collection of scenes in which rendering methods may fail. `run`
/// contains its test cases and their results. The page consists of an introduction, a table of all cases, and
/// a section for each cause of error with the cases that have it.
[[nodiscard]] std::string atlas_markdown(const AtlasRun& run);

/// Returns the images and results of all test cases as one HTML page with embedded images, otherwise like
/// atlas_markdown. `folder` is the output folder of run_atlas. Throws Error(invalid_input) if an image cannot
/// be read.
[[nodiscard]] std::string atlas_html(const AtlasRun& run, const std::filesystem::path& folder);

}  // namespace postlens
