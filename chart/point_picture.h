// Makes the image of one point of a chart, which is a method with certain settings.
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

/// Makes the images of the points of a chart. Its functions set `retraced` to the fraction of the image that
/// was computed by rays, and `warnings` to the codes of the warnings that occurred.
class PointPictures {
  public:
    /// Keeps references to all arguments.
    PointPictures(const ChartRequest& request, const Scene& scene, const ChartView& view)
        : request_(request), scene_(scene), view_(view) {}

    /// Returns the image of a point, made from the sample file `path`. The method `rays` does not read the
    /// file.
    [[nodiscard]] Image picture(const PlannedPoint& p, const std::filesystem::path& path, double& retraced,
                                std::vector<std::string>& warnings) const;
    /// Returns the image of a point with the given lens, made from the records of `frame`.
    [[nodiscard]] Image focused(const PlannedPoint& p, FocusFrame& frame, const ThinLens& lens,
                                double& retraced, std::vector<std::string>& warnings) const;

  private:
    const ChartRequest& request_;
    const Scene& scene_;
    const ChartView& view_;
};

}  // namespace postlens
