// Draws a path over the whole of its time.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "motionblur/paths/path_raster.h"

namespace postlens::test {

inline PathRaster draw(const std::vector<PathPoint>& points, int cells_per_px = 1,
                       const ShutterCurve& curve = ShutterCurve::box()) {
    return draw_path(points, glm::dvec2(0), points.front().time_s, points.back().time_s, curve, cells_per_px);
}

}  // namespace postlens::test
