// The plots of a chart: error against the seconds of one image, and against the cost per image of many.
#pragma once

#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// gnuplot script that draws, for each method, the error over the seconds of one image, without the trace.
/// Also draws the Pareto frontier of all points, the noise floor of the reference and the error of the
/// records. `affected`: takes the errors of the affected pixels only, and draws neither noise floor nor error
/// of the records.
[[nodiscard]] std::string speed_accuracy_script(const ChartData& data, bool affected);

/// gnuplot script that draws the Pareto frontiers of the methods that read sample files, if 1, 10 and 100
/// images share the cost of one trace, and the curve of distributed rays.
[[nodiscard]] std::string cost_script(const ChartData& data);

}  // namespace postlens
