// Finds the measurements of earlier runs of the same chart, so that they are not repeated.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/chart_data.h"
#include "chart/chart_plan.h"
#include "chart/chart_request.h"
#include "scene/scene.h"

namespace postlens {

/// Returns a text of everything that determines the measurements of a chart, to recognise earlier runs. The
/// number of rounds and the choice of points are not included.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the files with earlier measurements that a new run uses instead of measuring again. If the run
/// measures all points, this includes the files *.I-of-N.json in `folder`, which several machines wrote.
/// `chart`, the run's own file, comes last if it exists.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds the measurements of an earlier chart, stored in `path`, to `data`. If both contain the same point,
/// the one measured in more rounds is kept. Returns true if the chart was measured on another machine.
///
/// A chart with another chart_key (another scene or view) is ignored. But if `own` is true, `path` is the
/// file that this run will write, and Error(wrong_arguments) is thrown.
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts the measurements in `data` into the order of the plan: the sample files (traces) and the points
/// (methods with settings). Adds an empty entry for each one that is missing.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
