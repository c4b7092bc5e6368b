// Measures the points of a chart's plan in rounds. An interrupted run resumes.
#pragma once

#include <filesystem>

#include "chart/chart_data.h"
#include "chart/chart_request.h"

namespace postlens {

struct ChartRun {
    ChartData data;
    std::size_t kept = 0;            ///< number of timings that come from an earlier run of the same request
    std::vector<std::string> notes;  ///< notes of the scene's reader
    std::vector<std::string> missing;  ///< with Join::partial: names of points that are left out
};

/// Measures a chart into `folder`, which is created if its parent exists. After every point, chart.json is
/// written. Further files are reference.*.exr, pinhole.exr, and pictures/NAME.png and maps/NAME.png for every
/// point.
///
/// Results of an earlier run of the same request are kept. If the folder contains the chart of another
/// request, an error is thrown unless `restart` is set.
///
/// The time of a method starts when it opens the sample file, and the time of rays starts with the scene in
/// memory. Both end with the image in memory. The time of a trace runs from the scene in memory to the
/// written file.
///
/// Throws Error(interrupted), after which the finished points remain on disk. Also throws
/// Error(wrong_arguments), Error(invalid_input), Error(cannot_write) and Error(out_of_memory).
[[nodiscard]] ChartRun run_chart(const ChartRequest& request, const std::filesystem::path& folder,
                                 bool restart);

/// Returns a file name for a point, made of letters, digits, '-', '_' and '.'.
[[nodiscard]] std::string point_file_name(const std::string& name);

}  // namespace postlens
