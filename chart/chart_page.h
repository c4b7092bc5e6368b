// Writes a chart as one self-contained HTML page, which needs no network.
#pragma once

#include <filesystem>
#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// HTML with embedded images: the plots (if `folder` has them), the table, image and error map of every point
/// with a slider between them, the machine and the versions. `folder` is the output folder of run_chart.
/// Throws Error(invalid_input) if an image in it cannot be read.
[[nodiscard]] std::string chart_page(const ChartData& data, const std::filesystem::path& folder);

}  // namespace postlens
