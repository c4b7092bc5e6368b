// Keyframed motion, prepared for being asked at every ray's own instant.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "records/transform_key.h"

namespace postlens {

/// What transform_at says, without its searches and inverse cosines: rotations by slerp, the rest linearly.
class MotionPath {
  public:
    MotionPath() = default;
    explicit MotionPath(const std::vector<TransformKey>& keys);

    /// Position and orientation at an instant: world = translation + rotation * scale * p.
    struct Pose {
        glm::dvec3 translation{0};
        glm::dmat3 rotation{1};
        glm::dvec3 scale{1};
        [[nodiscard]] glm::dvec3 point(const glm::dvec3& p) const {
            return translation + rotation * (scale * p);
        }
        [[nodiscard]] glm::dvec3 direction(const glm::dvec3& v) const { return rotation * (scale * v); }
        /// The way back; p in the world.
        [[nodiscard]] glm::dvec3 unmoved_point(const glm::dvec3& p) const {
            return unmoved_direction(p - translation);
        }
        [[nodiscard]] glm::dvec3 unmoved_direction(const glm::dvec3& v) const {
            return (v * rotation) / scale;  // v * rotation: the transposed rotation times v
        }
        [[nodiscard]] glm::dmat4 matrix() const;
    };
    [[nodiscard]] Pose at(double time_s) const;

    /// Whether anything changes between two instants.
    [[nodiscard]] bool moves(double open_s, double close_s) const;
    /// open, the instants of keys that lie between, close.
    [[nodiscard]] std::vector<double> intervals(double open_s, double close_s) const;

  private:
    struct Interval {
        double begin_s = 0, per_s = 0;  // share = (t - begin) * per_s
        glm::dvec3 translation{0}, translation_step{0};
        glm::dvec3 scale{1}, scale_step{0};
        glm::dquat from{1, 0, 0, 0}, to{1, 0, 0, 0};
        double angle = 0, inverse_sine = 0;  // of the slerp; angle 0: lerp
        bool turns = false;
        glm::dmat3 rotation{1};  // where it does not turn
        [[nodiscard]] bool still() const {
            return !turns && translation_step == glm::dvec3(0) && scale_step == glm::dvec3(0);
        }
    };
    std::vector<Interval> intervals_;  // between keys; the first begins at the first key
    std::vector<double> times_s_;      // of the keys
    Pose first_, last_;
};

}  // namespace postlens
