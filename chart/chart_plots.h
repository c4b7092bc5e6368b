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

/// Returns a gnuplot script that plots the error of each method against its cost, the time per image. This
/// includes the time of tracing the sample file, divided by the number of images that are made from it: 1, 10
/// or 100. Methods that are beaten in both error and cost are omitted, except distributed ray tracing.
[[nodiscard]] std::string cost_script(const ChartData& data);

}  // namespace postlens
