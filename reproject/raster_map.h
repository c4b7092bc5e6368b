// How rigid motion of an object or of the camera changes the image: a 4x4 matrix maps the raster position and
// depth of a surface point from one instant to another.
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

/// Raster position and inverse depth, in 1/m, of a surface point. An inverse depth of 0 is infinitely far.
struct RasterPoint {
    double x = 0, y = 0, inverse_z = 0;
};

/// The first-order approximation of a motion (RasterMap) near one point of a surface.
struct RasterTangent {
    RasterPoint at;          ///< image of the point
    RasterPoint by_x, by_y;  ///< derivatives along the surface, per px to the right and down
    glm::dvec2 by_depth{0};  ///< derivative of the image with respect to inverse depth, px m
    double bend_px = 0;      ///< approximate second-order error at distance `reach`, px
};

/// Maps the raster position and depth z' of a surface point from one instant to another. For a perspective
/// camera, the map is a matrix on (x, y, 1, 1/z'), which includes points at infinity.
/// For an orthographic camera, it is a matrix on (x, y, z', 1), and points at infinity stay fixed.
class RasterMap {
  public:
    RasterMap() = default;
    RasterMap(const glm::dmat4& matrix, Projection projection)
        : m_(matrix), projection_(projection), identity_(matrix == glm::dmat4(1)) {}

    /// Maps a surface point from one instant to another. The point is given by its position on the raster, in
    /// px, and its inverse depth, in 1/m, and so is the result. Returns nothing if the mapped point lies
    /// behind the camera.
    [[nodiscard]] std::optional<RasterPoint> operator()(const RasterPoint& p) const;
    /// Returns the linear approximation of this map at the point `p` of a surface: the point to which `p` is
    /// mapped, and how this mapped point changes if `p` moves by 1 px in x or y. Returns nothing if some part
    /// of the mapped surface would lie behind the camera.
    /// - `slope`: gradient of the surface's inverse depth, in 1/m per px
    /// - `reach`: half the surface's width and height, in px
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

/// Displacement of a surface point's image, in px, if the scene is seen from a lens point instead of the
/// pinhole: `(I * inverse_focus_per_m - w) lens_px + offset_px`. I is the 2x2 unit matrix. For a directly
/// visible point, w is I / depth. For a reflected or refracted point, it is the matrix Record::w, in 1/m.
/// `offset_px` is the same for all points.
struct LensShift {
    glm::dvec2 lens_px{0};  ///< lens point (m) times film distance / pixel pitch, px m
    double inverse_focus_per_m = 0;
    glm::dvec2 offset_px{0};
    friend bool operator==(const LensShift&, const LensShift&) = default;
    [[nodiscard]] bool none() const { return *this == LensShift{}; }
};

/// Returns one map for a directly visible object: first its motion, then the displacement of its image
/// because it is seen from a lens point instead of the pinhole. Not valid for reflections. `motion` must
/// belong to a perspective camera, unless `lens` causes no displacement.
[[nodiscard]] RasterMap through_lens(const RasterMap& motion, const LensShift& lens);

/// Returns the matrix that maps a surface point on the raster to the camera's coordinates at the frame's
/// instant, both homogeneous. A point at the raster position (x, y), in px, with the depth z, in m, is (x, y,
/// 1, 1/z) for a perspective camera and (x, y, z, 1) for an orthographic one. Camera coordinates are in m; x
/// points to the right, y up, and the camera looks along -z.
[[nodiscard]] glm::dmat4 camera_from_raster(const SampleHeader& header);

/// The motions of all objects, as maps from one instant to another on the raster. The constructor reads them
/// from the header of the sample file. The functions set_displacement and set_keys replace the motion of
/// single objects.
class FrameMotion {
  public:
    explicit FrameMotion(const SampleHeader& header);

    /// Displacement on the raster, in px, as a function of time.
    using Displacement = std::function<glm::dvec2(double time_s)>;
    /// Replaces the motion of the object `id` by a displacement of its pixels in the image. `displacement`
    /// must include the motion that the camera causes. `breaks_s` lists the instants at which the velocity
    /// changes abruptly.
    void set_displacement(std::uint32_t id, Displacement displacement, std::vector<double> breaks_s);
    /// Replaces the rigid motion of one object in the world. The camera's motion stays the same.
    void set_keys(std::uint32_t id, const std::vector<TransformKey>& keys);

    /// Returns the object's motion from one instant to another. It maps a point's raster position and inverse
    /// depth at `from_s` to those at `to_s`. It is exactly the identity if nothing moves. `id` 0 is the
    /// background at infinity.
    [[nodiscard]] RasterMap map(std::uint32_t id, double from_s, double to_s) const;
    /// Returns the instants, in ascending order, at which the velocity of the object or the camera may change
    /// abruptly.
    [[nodiscard]] std::vector<double> breaks_s(std::uint32_t id) const;
    /// Whether the camera moves between two instants.
    [[nodiscard]] bool camera_moves(double open_s, double close_s) const;
    /// Returns the ids of the objects that have their own motion.
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
