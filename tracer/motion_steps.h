// How finely motion must be cut up where something takes it as straight from step to step.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "records/motion_path.h"
#include "tracer/shape_bounds.h"

namespace postlens {

/// What an error of a position is worth on the raster.
struct MotionAccuracy {
    /// px per metre there, at that instant; 0 where the camera cannot see (behind it).
    std::function<double(const glm::dvec3& world, double time_s)> px_per_m;
    double tolerance_px = 0.05;
};

/// Embree takes at most 129 time steps per geometry.
inline constexpr int most_motion_steps = 128;

/// Transforms world = step * object at equal times from begin to end, at least two. Between them Embree goes
/// linearly, matrix entry by matrix entry.
struct MotionSteps {
    std::vector<glm::dmat4> world_from_object;
    double error_px =
        0;  ///< how far a corner of the box strays from the true motion; may exceed the tolerance
};
/// As few steps as keep the corners of `box` (object space, before `base`) within the tolerance, doubling
/// from one to most_motion_steps. No key of the path may lie between begin and end.
[[nodiscard]] MotionSteps motion_steps(const MotionPath& path, const glm::dmat4& base, const Bounds& box,
                                       double begin_s, double end_s, const MotionAccuracy& accuracy);

/// Boxes at `steps` + 1 equal times which, taken linearly between, hold the moving shape all the time.
[[nodiscard]] std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape,
                                                const glm::dmat4& base, double begin_s, double end_s,
                                                int steps);

}  // namespace postlens
