// Where on the film what was recorded at one instant lies at others: every recorded point moves with its own
// id, seen by the camera of that instant.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "records/scene_motion.h"
#include "tracer/camera_model.h"

namespace postlens {

class FilmMotion {
  public:
    /// `from_s`: the instant of the records; `instants_s`: those that are asked about. `camera` must be the
    /// one that `motion` was made of.
    FilmMotion(const SceneMotion& motion, const Camera& camera, const CameraOverrides& overrides,
               double from_s, std::span<const double> instants_s);

    [[nodiscard]] std::size_t instants() const { return cameras_.size(); }
    /// Raster position, px, at instant number i of what id shows at `point` (world, m) at `from_s`; nothing
    /// where that is not in front of the camera.
    [[nodiscard]] std::optional<glm::dvec2> place(std::uint32_t id, const glm::dvec3& point,
                                                  std::size_t i) const;
    /// The same of a ray that hit nothing. An orthographic camera sees nothing always at the ray's own place,
    /// `at`.
    [[nodiscard]] std::optional<glm::dvec2> place_of_nothing(const glm::dvec3& direction,
                                                             const glm::dvec2& at, std::size_t i) const;

    /// Whether some id or the camera is elsewhere at one of the instants.
    [[nodiscard]] bool anything_moves() const { return camera_moves_ || !moving_.empty(); }
    [[nodiscard]] bool moves(std::uint32_t id) const { return moving_.contains(id); }
    /// Whether the camera's motion separates near from far, as every motion does but a turn about the
    /// pinhole.
    [[nodiscard]] bool parallax() const { return parallax_; }
    /// False where a ray surely meets none of the moving ids behind distance t, m.
    [[nodiscard]] bool may_meet_moving(const glm::dvec3& origin, const glm::dvec3& direction, double t) const;

  private:
    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    std::vector<CameraModel> cameras_;  ///< per instant
    /// Per moving id, per instant: the point at that instant from the point at `from_s`.
    std::unordered_map<std::uint32_t, std::vector<glm::dmat4>> moving_;
    std::vector<Ball> balls_;  ///< around the moving ids at `from_s`
    bool camera_moves_ = false, parallax_ = false;
};

/// The instants at which motion over a shutter is looked at: nine, evenly spread with both ends, and
/// `recorded_s`; growing.
[[nodiscard]] std::vector<double> looked_at_instants(double open_s, double close_s,
                                                     std::span<const double> recorded_s);

/// Instant number i of `count` (2 or more) that are spread evenly from open to close, both included.
[[nodiscard]] double even_instant(double open_s, double close_s, int i, int count);

}  // namespace postlens
