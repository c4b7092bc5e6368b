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

/// Returns a text (key) that describes everything on which the measurements of the command `chart` depend. A
/// run uses earlier measurements only if their key is equal to its own. The list of methods and the number of
/// repetitions are not part of it, because they do not change the measurement of a method.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the files that contain earlier measurements of the command `chart`, so that this run need not
/// repeat them. The last one is `chart`, the file that this run itself writes, if it exists already. A run
/// that makes the whole chart also uses *.I-of-N.json in `folder`, the results of machines that shared the
/// work.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds the measurements in the file `path`, which an earlier run of the command `chart` wrote, to `data`.
/// Returns true if they were made on another machine.
/// - `key`: the text by which this run recognises its own measurements (chart_key)
/// - `own`: true if this run will write to `path`. Then Error(wrong_arguments) is thrown if the file has
///   another key, because its chart would be overwritten
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts the measured points (methods with their settings) in `data` into the order of `plan`, the list of
/// the points that this run measures. Adds an empty entry for each point that is not measured yet.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
