// Measures the points of a chart's plan, round by round; an interrupted run resumes where it stopped.
#pragma once

#include <filesystem>

#include "chart/chart_data.h"
#include "chart/chart_request.h"

namespace postlens {

struct ChartRun {
    ChartData data;
    std::size_t kept = 0;            ///< number of timings taken from an earlier run of the same request
    std::vector<std::string> notes;  ///< notes of the scene's reader
};

/// Measures a chart into `folder`, which is created if its parent exists. Writes chart.json after every
/// point, reference.*.exr, pinhole.exr, and for every point pictures/NAME.png and maps/NAME.png. Results of
/// an earlier run of the same request are kept. A folder with a chart of another request is refused unless
/// `restart` is set. The seconds of a method run from opening the sample file to the image in memory; of
/// rays, from the scene in memory to the image in memory; of a trace, from the scene in memory to the file.
/// Throws Error(interrupted), which leaves the finished points on disk, Error(wrong_arguments),
/// Error(invalid_input), Error(cannot_write), Error(out_of_memory).
[[nodiscard]] ChartRun run_chart(const ChartRequest& request, const std::filesystem::path& folder,
                                 bool restart);

/// A file name for the point `name`. It has only letters, digits, '-', '_' and '.'.
[[nodiscard]] std::string point_file_name(const std::string& name);

}  // namespace postlens
