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

    /// Makes the image of the point `p`, i.e. with its method and settings, from the sample file `path`. The
    /// method "rays" traces the scene and does not read this file. If the method may trace additional rays,
    /// sets `retraced` to the fraction of the view samples that are rays. Otherwise, `retraced` keeps its
    /// value.
    [[nodiscard]] Image picture(const PlannedPoint& p, const std::filesystem::path& path, double& retraced,
                                std::vector<std::string>& warnings) const;
    /// Makes an image of the open sample file `frame` for the given lens, with the method and settings in
    /// `p`. Sets `retraced` as `picture` does.
    [[nodiscard]] Image focused(const PlannedPoint& p, FocusFrame& frame, const ThinLens& lens,
                                double& retraced, std::vector<std::string>& warnings) const;

  private:
    const ChartRequest& request_;
    const Scene& scene_;
    const ChartView& view_;
};

}  // namespace postlens
