// Approximates a motion by linear steps, because Embree interpolates motion linearly.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "records/motion/motion_path.h"
#include "scene/shape_bounds.h"

namespace postlens {

/// How accurately moving meshes must be placed in the image. Their motion is approximated by linear steps.
struct MotionAccuracy {
    /// Returns the scale of the image, px per metre, at a world point and an instant. 0 behind the camera.
    std::function<double(const glm::dvec3& world, double time_s)> px_per_m;
    double tolerance_px = 0.05;
};

/// Embree allows at most 129 time steps (instants) per geometry.
inline constexpr int most_motion_steps = 128;

/// Object-to-world matrices of a moving mesh, at two or more evenly spaced instants.
/// Between these instants, Embree interpolates each entry of the matrices linearly.
struct MotionSteps {
    std::vector<glm::dmat4> world_from_object;
    /// Largest error, px, that replacing the motion by linear steps causes at a corner of the object's
    /// bounding box.
    /// It may exceed the tolerance, because the number of steps is limited.
    double error_px = 0;
};
/// Approximates the motion of a mesh by linear steps, and returns the fewest steps with an error of position
/// within the tolerance of `accuracy`. Their number is a power of two, at most most_motion_steps. The mesh is
/// moved first by the matrix `base` and then by `path`. `box` is its bounding box before both, and the error
/// is measured at its corners.
///
/// No keyframe of `path` may lie between begin_s and end_s.
[[nodiscard]] MotionSteps motion_steps(const MotionPath& path, const glm::dmat4& base, const Bounds& box,
                                       double begin_s, double end_s, const MotionAccuracy& accuracy);

/// Returns bounding boxes of a moving shape at `steps` + 1 evenly spaced instants, for Embree.
/// Linear interpolation between them contains the shape at every instant.
[[nodiscard]] std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape,
                                                const glm::dmat4& base, double begin_s, double end_s,
                                                int steps);

}  // namespace postlens
