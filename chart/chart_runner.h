// Measures what a plan says, point by point and round by round; keeps what is finished.
#pragma once

#include <filesystem>

#include "chart/chart_data.h"
#include "chart/chart_request.h"

namespace postlens {

struct ChartRun {
    ChartData data;
    std::size_t kept = 0;            ///< times that an earlier run of the same request had measured
    std::vector<std::string> notes;  ///< of the scene's reader
};

/// Measures into `folder`, which is made if its parent exists: chart.json after every point, reference.*.exr,
/// pinhole.exr, and for every point pictures/NAME.png and maps/NAME.png. What is there already from a run of
/// the same request is kept. A folder with a chart of another request is refused unless `restart`.
/// Seconds are those of the methods in memory: from opening the sample file to the picture; of rays from the
/// scene in memory to the picture; of a trace from the scene in memory to the file.
/// Throws Error(interrupted) after keeping what is finished, Error(wrong_arguments), Error(invalid_input),
/// Error(cannot_write), Error(out_of_memory).
[[nodiscard]] ChartRun run_chart(const ChartRequest& request, const std::filesystem::path& folder,
                                 bool restart);

/// A file name for a point: letters, digits, '-', '_' and '.'.
[[nodiscard]] std::string point_file_name(const std::string& name);

}  // namespace postlens
