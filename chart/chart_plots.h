// The charts of a chart: error against seconds, and against the cost of each of many pictures.
#pragma once

#include <string>

#include "chart/chart_data.h"

namespace postlens {

/// gnuplot script: a curve per method over the seconds of one picture, sample file included in none; the
/// frontier of all; the noise floor of the reference and the floor of the records. `affected`: errors of the
/// affected pixels alone.
[[nodiscard]] std::string speed_accuracy_script(const ChartData& data, bool affected);

/// gnuplot script: the frontier of what is made from sample files, with a share of the trace in every
/// picture, where one file serves 1, 10 and 100 pictures; beside it the rays.
[[nodiscard]] std::string cost_script(const ChartData& data);

}  // namespace postlens
