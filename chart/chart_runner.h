// Measures the points of a chart's plan in rounds. An interrupted run resumes where it stopped.
#pragma once

#include <filesystem>

#include "chart/chart_data.h"
#include "chart/chart_request.h"

namespace postlens {

struct ChartRun {
    ChartData data;
    std::size_t kept = 0;            ///< number of timings that come from an earlier run of the same request
    std::vector<std::string> notes;  ///< notes of the scene's reader
};

/// Measures a chart into `folder`, which is created if its parent exists. Writes chart.json after every
/// point, reference.*.exr, pinhole.exr, and for every point pictures/NAME.png and maps/NAME.png. Results of
/// an earlier run of the same request are kept. A folder with the chart of another request is refused, unless
/// `restart` is set. The time of a method is measured from opening the sample file to the image in memory.
/// The time of rays is measured from the scene in memory to the image in memory. The time of a trace is
/// measured from the scene in memory to the file. Throws Error(interrupted); the finished points then remain
/// on disk. Also throws Error(wrong_arguments), Error(invalid_input), Error(cannot_write) and
/// Error(out_of_memory).
[[nodiscard]] ChartRun run_chart(const ChartRequest& request, const std::filesystem::path& folder,
                                 bool restart);

/// Returns a file name for the point `name`. It consists of letters, digits, '-', '_' and '.'.
[[nodiscard]] std::string point_file_name(const std::string& name);

}  // namespace postlens
