// One page with everything a chart found, for any browser, without a network.
#pragma once

#include <filesystem>
#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// HTML with its pictures inside: charts (where `folder` has them), the table, every point's picture and
/// error map beside each other under a slider, machine and versions. `folder` is what run_chart has filled.
/// Throws Error(invalid_input) where a picture of it cannot be read.
[[nodiscard]] std::string chart_page(const ChartData& data, const std::filesystem::path& folder);

}  // namespace postlens
