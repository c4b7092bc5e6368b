// Makes eye rays from random numbers, through points of the lens and at instants of the exposure [cook1984].
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "lens/shutter_curve.h"
#include "lens/traced/lens_view.h"
#include "records/motion/motion_path.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Random numbers for sixteen eye rays. x and y are raster positions, px.
/// The numbers for the lens point and the instant are in [0, 1).
struct LensSamples {
    alignas(64) std::array<float, 16> x, y, lens_u, lens_v, time;
};

class LensCamera {
  public:
    struct Settings {
        FocusGeometry lens;  ///< an aperture radius of 0 is a pinhole; `gain_px` determines the field of view
        TimeSpan span;
        ShutterCurve curve = ShutterCurve::box();
        std::shared_ptr<const Aperture> aperture = nullptr;  ///< null: a disc
        /// a traced lens prescription that has the geometry `lens`
        std::shared_ptr<const LensView> view = nullptr;
    };
    /// Creates a camera for a frame. `model` describes the frame: its raster (image size), its projection and
    /// the camera's pose. `camera` is the camera of the scene, and only its motion is used. An orthographic
    /// camera must have an aperture radius of 0 in `settings`.
    LensCamera(const Camera& camera, const CameraModel& model, const Settings& settings);

    /// Sixteen samples for which rays are made together. `x` and `y` are the positions in the image, in px.
    /// `lens` gives for each sample the lens point at which its ray starts, in lens radii along the raster's
    /// axes. Not for cameras with a lens prescription (a real lens).
    struct PointSamples {
        alignas(64) std::array<float, 16> x, y;
        std::array<glm::dvec2, 16> lens;
        alignas(64) std::array<float, 16> time;
    };
    /// Adds one ray to `batch` for each of the 16 samples. Each ray starts at the lens point that is given
    /// with its sample. If the lens may block light, i.e. if loses_rays() is true, the fraction of light that
    /// it transmits along each ray is appended to `weights`.
    void add_rays(const PointSamples& samples, RayBatch& batch, std::vector<float>& weights) const;

    /// Adds one ray, whose direction has unit length, to `batch` for each of the 16 samples. A sample gives
    /// the image position, the lens point at which the ray starts, and the instant. If loses_rays() is true,
    /// the fraction of light that the lens transmits along each ray is appended to `weights`.
    void add_rays(const LensSamples& samples, RayBatch& batch, std::vector<float>& weights) const;
    /// Returns whether the lens may block a part of the light. If so, add_rays gives each ray a weight. If
    /// not, all weights would be 1, so add_rays omits them.
    [[nodiscard]] bool loses_rays() const { return view_ || (aperture_ && aperture_->varies_over_field()); }

    /// A ray in double precision, to test the float rays. `time` is a fraction of the shutter interval.
    struct Ray {
        glm::dvec3 origin{0}, direction{0, 0, -1};
        double time = 0;
        double weight = 1;
    };
    [[nodiscard]] Ray ray(double x, double y, double lens_u, double lens_v, double time) const;

    /// Returns the raster position, in px, at which the pinhole camera sees a point of a lens ray. The ray
    /// starts at the lens point `unit` and goes to the point of the focus plane that the pinhole sees at (x,
    /// y), in px. Not for cameras with a lens prescription.
    /// - `unit`: in lens radii from the centre of the lens
    /// - `t`: distance of the point along the ray, in m
    [[nodiscard]] glm::dvec2 pinhole_px(double x, double y, const glm::dvec2& unit, double t) const;

    /// Returns the inverse depth, 1/m, of a plane at its point `world`, and the derivatives along raster x
    /// and y, per px. All are 0 if the plane is seen edge-on or the camera is orthographic. Not for moving
    /// cameras.
    [[nodiscard]] glm::dvec3 inverse_depth(const glm::dvec3& world, const glm::dvec3& normal) const;

    /// Returns the scale of the image at a world point: px per metre perpendicular to the optical axis.
    /// 0 for points behind the camera.
    [[nodiscard]] double px_per_m(const glm::dvec3& world, double time_s) const;
    [[nodiscard]] bool moves() const { return moves_; }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

  private:
    // Sixteen rays in the camera's frame. A ray starts at the point (qx, qy) of the lens, in m. `tx` and `ty`
    // give its direction: the displacement along the raster's x and y axes per unit of depth.
    struct Local {
        alignas(64) std::array<float, 16> qx, qy, tx, ty;
    };
    struct Frame {
        glm::dvec3 position{0}, right{1, 0, 0}, down{0, -1, 0}, forward{0, 0, -1};
    };
    struct Optics {
        float half_width, half_height, tangent_per_px, metres_per_px, aperture_radius_m, inverse_focus_per_m;
    };
    static void local_rays(const LensSamples& samples, const Optics& optics, Local& out);
    /// Computes the ray that starts at the lens point `unit` and belongs to the raster position (x, y), in
    /// px. `unit` is in lens radii from the lens centre. The ray, in the camera's frame, is stored as element
    /// `lane` of `out`. Returns false if the aperture blocks it.
    bool local_ray(double x, double y, const glm::dvec2& unit, std::size_t lane, Local& out) const;
    /// Adds rays that are given in the camera's frame.
    void add_local(const Local& local, std::array<float, 16> time, const std::array<float, 16>& weight,
                   RayBatch& batch, std::vector<float>& weights) const;
    void local_rays_of_view(const LensSamples& samples, Local& out, std::array<float, 16>& weight) const;
    void local_rays_of_aperture(const LensSamples& samples, Local& out, std::array<float, 16>& weight) const;
    [[nodiscard]] glm::dvec2 field_of(const glm::dvec2& tangent) const;
    static void world_rays(const Local& local, const Frame& frame, bool parallel, float* const to[6]);
    [[nodiscard]] Frame frame_at(double time_s) const;

    int width_, height_;
    bool orthographic_, moves_ = false;
    FocusGeometry lens_;
    std::shared_ptr<const Aperture> aperture_;  ///< null: a disc
    std::shared_ptr<const LensView> view_;      ///< null: a thin lens
    Optics optics_{};
    TimeSpan span_;
    ShutterCurve curve_;
    bool even_time_;
    Frame rest_, still_;  // camera frames without motion and at the opening of the shutter
    MotionPath path_;
};

}  // namespace postlens
