// Approximates a motion by linear steps, because Embree interpolates motion linearly. Computes how many steps
// are needed.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "records/motion/motion_path.h"
#include "scene/shape_bounds.h"

namespace postlens {

/// Tolerance for the error of a moving object's position in the image, and the scale that converts metres to
/// px.
struct MotionAccuracy {
    /// Returns the scale of the image at a world point and an instant, px per metre. 0 for points behind the
    /// camera.
    std::function<double(const glm::dvec3& world, double time_s)> px_per_m;
    double tolerance_px = 0.05;
};

/// Greatest number of steps. Embree allows at most 129 time steps (instants) per geometry.
inline constexpr int most_motion_steps = 128;

/// Object-to-world matrices at two or more evenly spaced instants, from begin to end. Embree interpolates
/// each entry of the matrices linearly between these instants.
struct MotionSteps {
    std::vector<glm::dmat4> world_from_object;
    /// Greatest distance, px, of a corner of the object's bounding box from its true position. It may exceed
    /// MotionAccuracy::tolerance_px.
    double error_px = 0;
};
/// Returns the smallest number of steps that keeps the corners of `box` within the tolerance. The number is a
/// power of two, up to most_motion_steps. `box` is in object space, before `base` is applied. No keyframe of
/// the path may lie between begin and end.
[[nodiscard]] MotionSteps motion_steps(const MotionPath& path, const glm::dmat4& base, const Bounds& box,
                                       double begin_s, double end_s, const MotionAccuracy& accuracy);

/// Returns boxes at `steps` + 1 evenly spaced instants. At any instant, the box interpolated linearly between
/// two of these boxes contains the moving shape.
[[nodiscard]] std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape,
                                                const glm::dmat4& base, double begin_s, double end_s,
                                                int steps);

}  // namespace postlens
