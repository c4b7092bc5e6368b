// The picture of one method of a case of the atlas, with all that the commands would warn of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/atlas_case.h"
#include "chart/chart_plan.h"

namespace postlens {

struct AtlasPicture {
    Image image;
    std::vector<std::string> warnings;  ///< codes, sorted, each once; those of the trace included
    double retraced_share = 0;
};

[[nodiscard]] TraceSettings atlas_trace_settings(const AtlasTrace& trace, const ChartRequest& request,
                                                 const ChartView& view);

/// `file`: the sample file of the method's trace, which rays do not need; files beside it are made and
/// removed. Throws Error.
[[nodiscard]] AtlasPicture atlas_picture(const AtlasMethod& method, const ChartRequest& request,
                                         const ChartView& view, const Scene& scene,
                                         const std::filesystem::path& file);

}  // namespace postlens
