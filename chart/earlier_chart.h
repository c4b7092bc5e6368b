// Measurements of earlier runs and of shares, which a run of the same chart keeps.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/chart_data.h"
#include "chart/chart_plan.h"
#include "chart/chart_request.h"
#include "scene/scene.h"

namespace postlens {

/// Key of a request: everything that determines the result of a point of the chart. The number of rounds and
/// the choice of points are not part of it.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Files of the earlier charts whose measurements a run keeps: the charts of shares in `folder`, then `chart`
/// if it exists. A run that measures a share keeps only `chart`.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds the measurements of an earlier run to `data`. If `data` has measured a point already, the measurement
/// with more rounds is kept. Returns true if the chart was measured on another machine. A chart with another
/// key than `key` is left alone, unless it is the run's `own`: then throws Error(wrong_arguments), which
/// names its folder.
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts traces and points into the order of the plan, and adds those that are not measured yet.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
