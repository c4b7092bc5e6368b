// Where what is recorded at a raster position and depth lies at another instant: every rigid motion of object
// and camera is a 4x4 matrix in these coordinates.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "records/motion_path.h"
#include "records/sample_header.h"

namespace postlens {

/// A point of the raster with its inverse depth, 1/m; 0: infinitely far.
struct RasterPoint {
    double x = 0, y = 0, inverse_z = 0;
};

/// Where a point of a surface comes to lie, and how its surroundings do.
struct RasterTangent {
    RasterPoint at;
    RasterPoint by_x, by_y;  ///< per px to the right and down
    glm::dvec2 by_depth{0};  ///< px by which what is nearer by 1/m comes to lie elsewhere
    double bend_px = 0;      ///< by which what is `reach` away lies elsewhere than to first order, about
};

/// Raster and depth to raster and depth. Perspective: in homogeneous coordinates (x, y, 1, 1/z') a motion is
/// a matrix, and what is infinitely far needs no case of its own. Orthographic: in (x, y, z', 1); what is
/// infinitely far stays.
class RasterMap {
  public:
    RasterMap() = default;
    RasterMap(const glm::dmat4& matrix, Projection projection)
        : m_(matrix), projection_(projection), identity_(matrix == glm::dmat4(1)) {}

    /// Nothing where the point comes to lie behind the camera.
    [[nodiscard]] std::optional<RasterPoint> operator()(const RasterPoint& p) const;
    /// Of a surface whose inverse depth goes on from `p` by `slope` per px to the right and down, as far as
    /// `reach` px either way. Nothing where any of that comes to lie behind the camera.
    [[nodiscard]] std::optional<RasterTangent> tangent(const RasterPoint& p, const glm::dvec2& slope,
                                                       const glm::dvec2& reach) const;
    [[nodiscard]] const glm::dmat4& matrix() const { return m_; }
    [[nodiscard]] Projection projection() const { return projection_; }
    [[nodiscard]] bool identity() const { return identity_; }

  private:
    glm::dmat4 m_{1};
    Projection projection_ = Projection::perspective;
    bool identity_ = true;
};

/// What a point of the lens adds to the movement of what it sees: `(1/s I - W) lens_px + offset_px`, W being
/// I / z' for what is seen directly.
struct LensShift {
    glm::dvec2 lens_px{0};  ///< film distance / pitch times the point of the lens, px m
    double inverse_focus_per_m = 0;
    glm::dvec2 offset_px{0};
    friend bool operator==(const LensShift&, const LensShift&) = default;
    [[nodiscard]] bool none() const { return *this == LensShift{}; }
};

/// A motion, then the lens's shift of what is seen directly. Perspective, unless the lens shifts nothing.
[[nodiscard]] RasterMap through_lens(const RasterMap& motion, const LensShift& lens);

/// The camera's frame at the frame's instant (m; x right, y up, looking along -z) from the raster, both
/// homogeneous: (x, y, 1, 1/z') for a perspective camera, (x, y, z', 1) for an orthographic one.
[[nodiscard]] glm::dmat4 camera_from_raster(const SampleHeader& header);

/// The motion of every id on the raster: what the header says, or what was put in its place.
class FrameMotion {
  public:
    explicit FrameMotion(const SampleHeader& header);

    /// Movement on the raster, px, as a function of time: in place of the id's motion and the camera's.
    using Displacement = std::function<glm::dvec2(double time_s)>;
    void set_displacement(std::uint32_t id, Displacement displacement, std::vector<double> breaks_s);
    /// Rigid motion of the id in the world; the camera's own stays.
    void set_keys(std::uint32_t id, const std::vector<TransformKey>& keys);

    /// From the raster at one instant to the raster at another, for what belongs to `id` (0: nothing, at
    /// infinity). Exactly the identity where neither the id nor the camera moves between the two.
    [[nodiscard]] RasterMap map(std::uint32_t id, double from_s, double to_s) const;
    /// Instants at which the motion of the id (with the camera's) may change its course, sorted.
    [[nodiscard]] std::vector<double> breaks_s(std::uint32_t id) const;
    /// Whether ids without a motion of their own move on the raster between two instants: the camera moves.
    [[nodiscard]] bool camera_moves(double open_s, double close_s) const;
    /// Ids with a motion of their own.
    [[nodiscard]] std::vector<std::uint32_t> moving_ids() const;

  private:
    struct Screen {
        Displacement displacement;
        std::vector<double> breaks_s;
    };
    Projection projection_;
    glm::dmat4 camera_from_raster_{1}, raster_from_camera_{1};
    glm::dmat4 world_from_camera_{1};  ///< at the frame's instant
    double time_s_ = 0;
    MotionPath camera_;
    std::vector<double> camera_breaks_s_;
    std::map<std::uint32_t, MotionPath> rigid_;
    std::map<std::uint32_t, std::vector<double>> rigid_breaks_s_;
    std::map<std::uint32_t, Screen> screen_;

    [[nodiscard]] glm::dmat4 world_from_camera(double time_s) const;
};

}  // namespace postlens
