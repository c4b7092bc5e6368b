// Approximates a motion by linear steps for Embree, which interpolates linearly between steps. Computes how
// many steps are needed.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "records/motion/motion_path.h"
#include "scene/shape_bounds.h"

namespace postlens {

/// Converts errors of positions to errors on the raster, and stores their tolerance.
struct MotionAccuracy {
    /// Scale of the image at a world point and an instant, px per metre; 0 behind the camera.
    std::function<double(const glm::dvec3& world, double time_s)> px_per_m;
    double tolerance_px = 0.05;
};

/// Greatest number of steps. Embree allows at most 129 time steps (instants) per geometry.
inline constexpr int most_motion_steps = 128;

/// Transforms from object to world space at two or more evenly spaced instants from begin to end. Embree
/// interpolates each entry of the matrices linearly between the instants.
struct MotionSteps {
    std::vector<glm::dmat4> world_from_object;
    /// greatest distance, px, of a corner of the box from its true position; may exceed the tolerance
    double error_px = 0;
};
/// Returns as few steps as keep the corners of `box` (in object space, before `base` is applied) within the
/// tolerance. The number of steps is a power of two, up to most_motion_steps. No keyframe of the path may lie
/// between begin and end.
[[nodiscard]] MotionSteps motion_steps(const MotionPath& path, const glm::dmat4& base, const Bounds& box,
                                       double begin_s, double end_s, const MotionAccuracy& accuracy);

/// Returns boxes at `steps` + 1 evenly spaced instants. Boxes interpolated linearly between these contain the
/// moving shape at every instant.
[[nodiscard]] std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape,
                                                const glm::dmat4& base, double begin_s, double end_s,
                                                int steps);

}  // namespace postlens
