// Predicts where a surface point recorded at one instant lies on the raster at other instants.
// The prediction uses the motion of the camera and of the point's object.
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
    /// Predicts where points recorded at the instant `from_s` appear on the raster at the instants
    /// `instants_s`.
    /// `motion` must have been made from `camera`.
    FilmMotion(const SceneMotion& motion, const Camera& camera, const CameraOverrides& overrides,
               double from_s, std::span<const double> instants_s);

    [[nodiscard]] std::size_t instants() const { return cameras_.size(); }
    /// Returns the raster position, px, at which the camera sees a moving point at the i-th of the instants
    /// `instants_s`. (The constructor receives these instants, and the instant `from_s`.) The point is fixed
    /// to object `id`, and `point` is its world position, m, at the instant `from_s`. Empty if the point is
    /// behind the camera.
    [[nodiscard]] std::optional<glm::dvec2> place(std::uint32_t id, const glm::dvec3& point,
                                                  std::size_t i) const;
    /// Returns the raster position, px, at which the camera sees the background at the i-th instant. The
    /// background is infinitely distant and was found by an eye ray with the direction `direction`, at the
    /// raster position `at`, px. Empty if it is then behind the camera. An orthographic camera sees the same
    /// background at every position, so for it, the result is `at`.
    [[nodiscard]] std::optional<glm::dvec2> place_of_nothing(const glm::dvec3& direction,
                                                             const glm::dvec2& at, std::size_t i) const;

    /// Returns true if the camera or an object moves: if its pose at one of the examined instants differs
    /// from its pose at the instant `from_s`, from which the motion is predicted.
    [[nodiscard]] bool anything_moves() const { return camera_moves_ || !moving_.empty(); }
    [[nodiscard]] bool moves(std::uint32_t id) const { return moving_.contains(id); }
    /// Returns true if the motion of the camera causes parallax. A rotation about the pinhole causes none.
    [[nodiscard]] bool parallax() const { return parallax_; }
    /// Returns false only if the ray certainly hits no moving object beyond the distance t, m.
    [[nodiscard]] bool may_meet_moving(const glm::dvec3& origin, const glm::dvec3& direction, double t) const;

  private:
    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    std::vector<CameraModel> cameras_;  ///< per instant
    /// The motion of each moving object, by its id. There is one matrix for each examined instant. It maps
    /// the object's world positions at the instant `from_s`, at which the records were traced, to its world
    /// positions at the examined instant.
    std::unordered_map<std::uint32_t, std::vector<glm::dmat4>> moving_;
    std::vector<Ball> balls_;  ///< bounding balls of the moving objects at `from_s`
    bool camera_moves_ = false, parallax_ = false;
};

/// Returns the instants of a shutter interval at which the positions of objects are computed, to find out
/// what motion reveals. They are ascending and contain:
/// - nine evenly spaced instants, including both ends
/// - the recorded instants `recorded_s`
/// - the keyframes within the interval. If there are more than 32, 32 of them are chosen quasi-randomly.
[[nodiscard]] std::vector<double> looked_at_instants(const SceneMotion& motion, double open_s, double close_s,
                                                     std::span<const double> recorded_s);

/// Returns instant i of `count` (at least 2) evenly spaced instants from open to close, including both ends.
[[nodiscard]] double even_instant(double open_s, double close_s, int i, int count);

}  // namespace postlens
