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
/// repetitions are not part of the key, because they do not change the measurement of a method.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the files that contain earlier measurements of the command `chart`, so that a new run need not
/// repeat them. If the run measures all points (methods with settings), these include the files *.I-of-N.json
/// in `folder`, each of which one of N machines wrote. The last one is `chart`, the file of the run itself,
/// if it exists.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds the measurements in the file `path`, which an earlier run of the command `chart` wrote, to `data`.
/// Returns true if they were made on another machine.
/// - `key`: chart_key of this run. A file with another key contains other measurements and is ignored
/// - `own`: true if the file is this run's own output file. In this case, another key is an error, because
///   the file would be overwritten: throws Error(wrong_arguments)
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts `data` into the order of `plan`, and adds an empty entry for each missing measurement.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
