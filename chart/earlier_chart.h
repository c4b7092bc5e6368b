// Finds measurements of earlier runs of the same chart, or of shares (parts) of it, so that they need not be
// repeated.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/chart_data.h"
#include "chart/chart_plan.h"
#include "chart/chart_request.h"
#include "scene/scene.h"

namespace postlens {

/// Returns a text that identifies a request. It contains everything that determines the result of a point.
/// The number of rounds and the choice of points are not included.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the files of earlier charts whose measurements a run keeps. For a run of the whole chart, these
/// are the files of the chart's shares (parts) in `folder`. For every run, `chart` comes last, if it exists.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds the measurements of the earlier chart in `path` to `data`. If both contain a point, the measurement
/// with more rounds is kept. Returns true if the earlier chart was measured on another machine. A chart whose
/// key differs from `key` is ignored. If it is the file of this run (`own` is true), Error(wrong_arguments)
/// with the name of the folder is thrown instead.
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts traces and points into the order of the plan. Adds empty entries for those that have not been
/// measured.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
