// Writes a chart as one self-contained HTML page, which needs no network.
#pragma once

#include <filesystem>
#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// Returns HTML with embedded images. The page shows the plots (if `folder` has any), the table, the machine,
/// and the versions of the programs. For every point, it shows the image and its error map with a slider
/// between them. `folder` is the output folder of run_chart. Throws Error(invalid_input) if an image in
/// `folder` cannot be read.
[[nodiscard]] std::string chart_page(const ChartData& data, const std::filesystem::path& folder);

}  // namespace postlens
