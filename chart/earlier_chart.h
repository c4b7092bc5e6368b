// Finds the measurements of earlier runs of the same chart, or of its shares (parts), so that they are not
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

/// Returns a text of everything that determines the measurements of a chart, to recognise earlier runs. The
/// number of rounds and the choice of points are not included.
[[nodiscard]] std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene);

/// Returns the earlier charts whose measurements a new run keeps. A run of the whole chart also uses its
/// shares (parts) in `folder`. `chart` comes last, if it exists.
[[nodiscard]] std::vector<std::filesystem::path> earlier_charts(const ChartRequest& request,
                                                                const std::filesystem::path& folder,
                                                                const std::filesystem::path& chart);

/// Adds an earlier chart's measurements to `data`. If both contain the same point, the one with more rounds
/// is kept. Returns true if the chart was measured on another machine.
///
/// A chart with another chart_key is ignored. If it is the run's own (`own`), Error(wrong_arguments) is
/// thrown.
[[nodiscard]] bool take_over_chart(const std::filesystem::path& path, const std::string& key, bool own,
                                   ChartData& data);

/// Sorts the traces and measured points of a chart into the order of its plan. Adds empty entries for missing
/// ones.
void arrange_by_plan(const ChartPlan& plan, ChartData& data);

}  // namespace postlens
