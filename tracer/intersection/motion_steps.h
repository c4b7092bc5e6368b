// Approximates a motion by linear steps, because Embree interpolates motion linearly.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "records/motion/motion_path.h"
#include "scene/shape_bounds.h"

namespace postlens {

/// Accuracy with which moving meshes appear at the right position in the image. Embree moves a mesh linearly
/// between a few instants, so at other instants its position has an error. This error should be at most
/// `tolerance_px`.
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
    /// Largest error, px, of the mesh's position in the image, measured at the corners of its bounding box.
    /// It arises because the mesh moves linearly between the matrices above instead of along its exact path.
    /// It may exceed MotionAccuracy::tolerance_px, because the number of steps is limited.
    double error_px = 0;
};
/// Divides the motion of a mesh from begin_s to end_s into steps in which it moves linearly. Returns the
/// smallest number of steps, a power of two up to most_motion_steps, for which the error at the corners of
/// `box` is within the tolerance. No keyframe of `path` may lie between begin_s and end_s.
/// - `base`: places the mesh in its rest position; `path` then moves it
/// - `box`: bounding box of the mesh before `base` and `path`
[[nodiscard]] MotionSteps motion_steps(const MotionPath& path, const glm::dmat4& base, const Bounds& box,
                                       double begin_s, double end_s, const MotionAccuracy& accuracy);

/// Returns bounding boxes of a moving shape at `steps` + 1 evenly spaced instants, for Embree.
/// Linear interpolation between them contains the shape at every instant.
[[nodiscard]] std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape,
                                                const glm::dmat4& base, double begin_s, double end_s,
                                                int steps);

}  // namespace postlens
