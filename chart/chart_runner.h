// Measures the time and the error of several methods that blur images. Times vary, so each is measured
// several times, in rounds. An interrupted run can be resumed.
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

/// Makes a chart, which compares the error and the time of several methods for one scene, in `folder`. The
/// folder is created if its parent exists. Earlier measurements of the same request are kept. If the folder
/// contains another request's chart, `restart` must be set.
///
/// Throws Error(interrupted); finished measurements remain. Also throws Error(wrong_arguments),
/// Error(invalid_input), Error(cannot_write) and Error(out_of_memory).
[[nodiscard]] ChartRun run_chart(const ChartRequest& request, const std::filesystem::path& folder,
                                 bool restart);

/// Returns a file name for a measured point of a chart, made of letters, digits, '-', '_' and '.'.
[[nodiscard]] std::string point_file_name(const std::string& name);

}  // namespace postlens
