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

/// Returns a text that identifies the measurements of the command `chart`: all that determines them. A run
/// uses only earlier measurements with equal text. How often and for which methods it measures is not
/// included.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the files with earlier measurements, which a new run of the command `chart` does not repeat. If
/// the run measures all points (methods with settings), this includes the files *.I-of-N.json in `folder`,
/// which several machines wrote. `chart`, the run's own file, comes last if it exists.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Reads the file `path` of an earlier run of the command `chart`, and adds its measurements to `data`.
/// Returns true if another machine made them.
/// - `key`: chart_key of this run. A file with another key is ignored
/// - `own`: true if the file is this run's own output file. If this file has another key, throws
///   Error(wrong_arguments)
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts `data` into the order of `plan`, and adds an empty entry for each missing measurement.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
