// Motion in raster coordinates: a rigid motion of object and camera maps raster position and depth at one
// instant to those at another by a 4x4 matrix.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "records/motion/motion_path.h"
#include "records/sample_header.h"

namespace postlens {

/// A point of the raster with its inverse depth, 1/m; 0: infinitely far.
struct RasterPoint {
    double x = 0, y = 0, inverse_z = 0;
};

/// First-order map of a surface around one of its points.
struct RasterTangent {
    RasterPoint at;          ///< image of the point
    RasterPoint by_x, by_y;  ///< derivatives along the surface, per px to the right and down
    glm::dvec2 by_depth{0};  ///< derivative of the image by inverse depth, px m
    double bend_px = 0;      ///< about the second-order error at distance `reach`, px
};

/// A map of raster position and depth. Perspective: a matrix on homogeneous (x, y, 1, 1/z'), which includes
/// points at infinity. Orthographic: a matrix on (x, y, z', 1); points at infinity do not move.
class RasterMap {
  public:
    RasterMap() = default;
    RasterMap(const glm::dmat4& matrix, Projection projection)
        : m_(matrix), projection_(projection), identity_(matrix == glm::dmat4(1)) {}

    /// Image of a point; none if it lies behind the camera.
    [[nodiscard]] std::optional<RasterPoint> operator()(const RasterPoint& p) const;
    /// Tangent at `p` of a surface whose inverse depth changes by `slope` per px to the right and down, and
    /// that extends `reach` px either way. None if a part of its image lies behind the camera.
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

/// The shift of a node's image for one lens point: `(1/s I - W) lens_px + offset_px`; W = I / z' for primary
/// nodes.
struct LensShift {
    glm::dvec2 lens_px{0};  ///< lens point (m) times film distance / pixel pitch, px m
    double inverse_focus_per_m = 0;
    glm::dvec2 offset_px{0};
    friend bool operator==(const LensShift&, const LensShift&) = default;
    [[nodiscard]] bool none() const { return *this == LensShift{}; }
};

/// `motion`, then the shift of primary nodes by the lens. Must be perspective, unless the shift is 0.
[[nodiscard]] RasterMap through_lens(const RasterMap& motion, const LensShift& lens);

/// The camera's frame at the frame's instant (m; x right, y up, looking along -z) from the raster, both
/// homogeneous: (x, y, 1, 1/z') for a perspective camera, (x, y, z', 1) for an orthographic one.
[[nodiscard]] glm::dmat4 camera_from_raster(const SampleHeader& header);

/// The motion of every object on the raster: from the file's header, or as set later.
class FrameMotion {
  public:
    explicit FrameMotion(const SampleHeader& header);

    /// Displacement on the raster, px, as a function of time.
    using Displacement = std::function<glm::dvec2(double time_s)>;
    /// Replaces the motion of one object on the raster, including the share that the camera's motion has in
    /// it.
    void set_displacement(std::uint32_t id, Displacement displacement, std::vector<double> breaks_s);
    /// Replaces the rigid motion of one object in the world. The camera's motion stays.
    void set_keys(std::uint32_t id, const std::vector<TransformKey>& keys);

    /// Map from the raster at one instant to the raster at another, for the object `id` (0: background at
    /// infinity). Exactly the identity if neither object nor camera moves between the two.
    [[nodiscard]] RasterMap map(std::uint32_t id, double from_s, double to_s) const;
    /// Sorted instants at which the motion of the object or of the camera may have a corner.
    [[nodiscard]] std::vector<double> breaks_s(std::uint32_t id) const;
    /// Whether the camera moves between two instants.
    [[nodiscard]] bool camera_moves(double open_s, double close_s) const;
    /// Ids of objects with their own motion.
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
