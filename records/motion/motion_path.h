// Keyframed motion, prepared for quick computation of the pose at the instant of a ray.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "records/motion/transform_key.h"

namespace postlens {

/// Interpolates keyframes like transform_at: rotations by slerp, translations and scales linearly. The angles
/// between keys, and the inverses of their sines, are precomputed.
class MotionPath {
  public:
    MotionPath() = default;
    explicit MotionPath(const std::vector<TransformKey>& keys);

    /// Position, orientation and scale of an object at one instant. Point p of the object has the world
    /// position translation + rotation * (scale * p).
    struct Pose {
        glm::dvec3 translation{0};
        glm::dmat3 rotation{1};
        glm::dvec3 scale{1};
        [[nodiscard]] glm::dvec3 point(const glm::dvec3& p) const {
            return translation + rotation * (scale * p);
        }
        [[nodiscard]] glm::dvec3 direction(const glm::dvec3& v) const { return rotation * (scale * v); }
        /// Inverse of `point`: p is in world coordinates.
        [[nodiscard]] glm::dvec3 unmoved_point(const glm::dvec3& p) const {
            return unmoved_direction(p - translation);
        }
        [[nodiscard]] glm::dvec3 unmoved_direction(const glm::dvec3& v) const {
            return (v * rotation) / scale;  // v * rotation is transpose(rotation) * v
        }
        [[nodiscard]] glm::dmat4 matrix() const;
    };
    [[nodiscard]] Pose at(double time_s) const;

    /// True if the transform changes between two instants.
    [[nodiscard]] bool moves(double open_s, double close_s) const;
    /// Returns open_s, the keyframes inside the exposure and close_s, in ascending order. Between these
    /// instants, the motion is smooth.
    [[nodiscard]] std::vector<double> intervals(double open_s, double close_s) const;

  private:
    struct Interval {
        double begin_s = 0, per_s = 0;  // (t - begin_s) * per_s goes from 0 to 1 between the keys
        glm::dvec3 translation{0}, translation_step{0};
        glm::dvec3 scale{1}, scale_step{0};
        glm::dquat from{1, 0, 0, 0}, to{1, 0, 0, 0};
        double angle = 0, inverse_sine = 0;  // for slerp; an angle of 0 means linear interpolation
        bool turns = false;
        glm::dmat3 rotation{1};  // used if `turns` is false
        [[nodiscard]] bool still() const {
            return !turns && translation_step == glm::dvec3(0) && scale_step == glm::dvec3(0);
        }
    };
    std::vector<Interval> intervals_;  // between keys; the first begins at the first key
    std::vector<double> times_s_;      // instants of the keys
    Pose first_, last_;
};

}  // namespace postlens
