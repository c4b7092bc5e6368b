// Makes the image of one method for a case of the atlas, and collects the warnings that occur. The atlas is a
// collection of scenes with which methods are tested and in which some of them fail.
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

/// Makes an image for a test case from the sample file `file`. The method "rays" traces rays into `scene`
/// instead. `view` contains the lens, shutter and camera. Temporary files are written to the folder of
/// `file`. Throws Error.
[[nodiscard]] AtlasPicture atlas_picture(const AtlasMethod& method, const ChartRequest& request,
                                         const ChartView& view, const Scene& scene,
                                         const std::filesystem::path& file);

}  // namespace postlens
