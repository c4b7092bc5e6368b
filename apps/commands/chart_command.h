// The command `chart`.
#pragma once

#include <string>

#include "apps/command.h"
#include "chart/chart_request.h"

namespace postlens {

struct ChartOptions {
    ExposureOption exposure;
    ChartRequest request;
    std::string output;  ///< output folder
    bool restart = false;
};

[[nodiscard]] CommandResult run_chart_command(const ChartOptions& options);

}  // namespace postlens
