// Writes a chart as one self-contained HTML page.
#pragma once

#include <filesystem>
#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// Returns a chart as an HTML page with embedded images: plots, the table, the machine, and each measured
/// image with its error map.
///
/// `folder` is the output folder of run_chart. Throws Error(invalid_input) if an image there cannot be read.
[[nodiscard]] std::string chart_page(const ChartData& data, const std::filesystem::path& folder);

}  // namespace postlens
