// `chart`: its options, and what it gives back.
#pragma once

#include <string>

#include "apps/command.h"
#include "chart/chart_request.h"

namespace postlens {

struct ChartOptions {
    ExposureOption exposure;
    ChartRequest request;
    std::string output;  ///< a folder
    bool restart = false;
};

[[nodiscard]] CommandResult run_chart_command(const ChartOptions& options);

}  // namespace postlens
