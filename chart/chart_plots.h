// The plots of a chart. One shows error against the time of a single image. The other shows error against the
// cost per image if many images share a trace.
#pragma once

#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// Returns a gnuplot script that plots, for each method, the error against the seconds of one image. The time
/// of the trace is not included. The plot also shows the Pareto frontier of all points, the noise floor (the
/// error of the reference), and the error of the records (measured without blur). If `affected` is set, the
/// plot shows only the errors of the pixels that blur affects, without noise floor and error of the records.
[[nodiscard]] std::string speed_accuracy_script(const ChartData& data, bool affected);

/// Returns a gnuplot script that plots the error against the cost per image if 1, 10 or 100 images share one
/// trace. It shows the Pareto frontiers of the methods that read sample files, and the curve of distributed
/// ray tracing.
[[nodiscard]] std::string cost_script(const ChartData& data);

}  // namespace postlens
