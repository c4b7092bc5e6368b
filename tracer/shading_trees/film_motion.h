// Predicts where a point recorded at one instant appears on the film at other instants: the point moves with
// the object that its id names, and the camera moves as well.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "records/motion/scene_motion.h"
#include "tracer/camera_model.h"

namespace postlens {

class FilmMotion {
  public:
    /// `from_s`: the instant of the records. `instants_s`: the instants to predict for. `camera` must be the
    /// camera from which `motion` was made.
    FilmMotion(const SceneMotion& motion, const Camera& camera, const CameraOverrides& overrides,
               double from_s, std::span<const double> instants_s);

    [[nodiscard]] std::size_t instants() const { return cameras_.size(); }
    /// Raster position, px, at instant i, of the point of object `id` that is at `point` (world, m) at
    /// `from_s`. Empty if it is then behind the camera.
    [[nodiscard]] std::optional<glm::dvec2> place(std::uint32_t id, const glm::dvec3& point,
                                                  std::size_t i) const;
    /// Raster position, px, at instant i, of the point at infinity in `direction`, for a ray that hit
    /// nothing. With an orthographic camera it is the ray's own position `at`.
    [[nodiscard]] std::optional<glm::dvec2> place_of_nothing(const glm::dvec3& direction,
                                                             const glm::dvec2& at, std::size_t i) const;

    /// True if the pose of an object or the camera at one of the instants differs from that at `from_s`.
    [[nodiscard]] bool anything_moves() const { return camera_moves_ || !moving_.empty(); }
    [[nodiscard]] bool moves(std::uint32_t id) const { return moving_.contains(id); }
    /// True if the camera's motion causes parallax between near and far points, which every motion does
    /// except a rotation about the pinhole.
    [[nodiscard]] bool parallax() const { return parallax_; }
    /// False only if the ray cannot hit a moving object beyond distance t, m.
    [[nodiscard]] bool may_meet_moving(const glm::dvec3& origin, const glm::dvec3& direction, double t) const;

  private:
    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    std::vector<CameraModel> cameras_;  ///< per instant
    /// Per moving id and instant: maps a point at `from_s` to its position at that instant.
    std::unordered_map<std::uint32_t, std::vector<glm::dmat4>> moving_;
    std::vector<Ball> balls_;  ///< bounding balls of the moving objects at `from_s`
    bool camera_moves_ = false, parallax_ = false;
};

/// The instants at which motion during a shutter interval is sampled, in ascending order: nine evenly spaced
/// ones including both ends, and `recorded_s`.
[[nodiscard]] std::vector<double> looked_at_instants(double open_s, double close_s,
                                                     std::span<const double> recorded_s);

/// Instant i of `count` (at least 2) instants spaced evenly from open to close, both included.
[[nodiscard]] double even_instant(double open_s, double close_s, int i, int count);

}  // namespace postlens
