// Makes the image of one method for a case of the atlas, and collects its warnings. The atlas is a collection
// of scenes with which methods are tested.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/atlas/atlas_case.h"
#include "chart/chart_plan.h"

namespace postlens {

struct AtlasPicture {
    Image image;
    std::vector<std::string> warnings;  ///< codes, sorted, each once
    double retraced_share = 0;
};

[[nodiscard]] TraceSettings atlas_trace_settings(const AtlasTrace& trace, const ChartRequest& request,
                                                 const ChartView& view);

/// Makes the image of `method` for the lens, shutter and camera in `view`. Reads the sample file `file`,
/// unless the method is "rays". Temporary files are written beside `file`. Throws Error.
[[nodiscard]] AtlasPicture atlas_picture(const AtlasMethod& method, const ChartRequest& request,
                                         const ChartView& view, const Scene& scene,
                                         const std::filesystem::path& file);

}  // namespace postlens
