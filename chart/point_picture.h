// Makes the image of one point of a chart.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "chart/chart_plan.h"
#include "chart/chart_request.h"
#include "focus/frame.h"
#include "pictures/image.h"
#include "scene/scene.h"

namespace postlens {

/// Makes the images that a chart compares with the reference.
class PointPictures {
  public:
    /// Keeps references to all arguments.
    PointPictures(const ChartRequest& request, const Scene& scene, const ChartView& view)
        : request_(request), scene_(scene), view_(view) {}

    /// Makes an image from the sample file `path` with the method and the settings in `p`. The method "rays"
    /// traces the scene instead. If the method may replace view samples (pixels of single views) by traced
    /// rays, sets `retraced` to the fraction replaced.
    [[nodiscard]] Image picture(const PlannedPoint& p, const std::filesystem::path& path, double& retraced,
                                std::vector<std::string>& warnings) const;
    /// Makes an image from the open sample file `frame` for the given lens, with the method and the settings
    /// in `p`. If the method may replace view samples (pixels of single views) by traced rays, sets
    /// `retraced` to the fraction replaced.
    [[nodiscard]] Image focused(const PlannedPoint& p, FocusFrame& frame, const ThinLens& lens,
                                double& retraced, std::vector<std::string>& warnings) const;

  private:
    const ChartRequest& request_;
    const Scene& scene_;
    const ChartView& view_;
};

}  // namespace postlens
