// Finds how many linear steps approximate a motion, for Embree, which interpolates linearly between steps.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "records/motion/motion_path.h"
#include "scene/shape_bounds.h"

namespace postlens {

/// Converts errors of positions to errors on the raster, and holds their tolerance.
struct MotionAccuracy {
    /// Scale of the image at a world point and an instant, px per metre; 0 behind the camera.
    std::function<double(const glm::dvec3& world, double time_s)> px_per_m;
    double tolerance_px = 0.05;
};

/// Greatest number of steps: Embree allows at most 129 time steps per geometry.
inline constexpr int most_motion_steps = 128;

/// Transforms from object to world space at evenly spaced instants from begin to end, at least two. Embree
/// interpolates each matrix entry linearly between them.
struct MotionSteps {
    std::vector<glm::dmat4> world_from_object;
    double error_px =
        0;  ///< greatest distance of a corner of the box from its true position; may exceed the tolerance
};
/// The smallest power of two of steps, up to most_motion_steps, that keeps the corners of `box` (object
/// space, before `base`) within the tolerance. No key of the path may lie between begin and end.
[[nodiscard]] MotionSteps motion_steps(const MotionPath& path, const glm::dmat4& base, const Bounds& box,
                                       double begin_s, double end_s, const MotionAccuracy& accuracy);

/// Boxes at `steps` + 1 evenly spaced instants. Interpolated linearly between these, they contain the moving
/// shape at every instant.
[[nodiscard]] std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape,
                                                const glm::dmat4& base, double begin_s, double end_s,
                                                int steps);

}  // namespace postlens
