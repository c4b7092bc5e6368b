// Measurements that a chart keeps from earlier runs of the same chart, or of shares (parts) of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/chart_data.h"
#include "chart/chart_plan.h"
#include "chart/chart_request.h"
#include "scene/scene.h"

namespace postlens {

/// Key of a request. It contains everything that determines the result of a point, but not the number of
/// rounds or the choice of points.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the files of earlier charts whose measurements a run keeps. In a run of the whole chart, they are
/// first the files of the chart's shares (parts) in `folder`. The last is `chart`, if it exists.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds the measurements of an earlier chart to `data`. If a point is in both, the measurement with more
/// rounds is kept. Returns true if the chart was measured on another machine. A chart whose key differs from
/// `key` is ignored. If `own` is set, it is the run's own chart, and a different key throws
/// Error(wrong_arguments) with the name of its folder.
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts traces and points into the order of the plan, and adds empty entries for those that have not been
/// measured.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
