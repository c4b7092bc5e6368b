// Plots the error of each method's images: against the time of one image, and against the cost per image if
// several images share one sample file.
#pragma once

#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// Returns a gnuplot script that plots each method's error against the seconds of one image, without the time
/// of tracing. The plot includes the Pareto frontier and the noise floor.
///
/// With `affected`, it shows the errors of the pixels that blur affects.
[[nodiscard]] std::string speed_accuracy_script(const ChartData& data, bool affected);

/// Returns a gnuplot script that plots error against cost per image if 1, 10 or 100 images share a trace. The
/// cost of ray tracing is shown for comparison.
[[nodiscard]] std::string cost_script(const ChartData& data);

}  // namespace postlens
