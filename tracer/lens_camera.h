// The camera with a lens and a shutter: numbers in [0, 1) to eye rays, each from its own point of the lens at
// its own instant [cook1984].
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "lens/prescription/lens_view.h"
#include "lens/shutter_curve.h"
#include "records/motion_path.h"
#include "tracer/camera_model.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// Sixteen samples: positions on the raster, px; lens and time in [0, 1).
struct LensSamples {
    alignas(64) std::array<float, 16> x, y, lens_u, lens_v, time;
};

class LensCamera {
  public:
    struct Settings {
        FocusGeometry lens;  ///< aperture radius 0: a pinhole; `gain_px` sets the field of view
        TimeSpan span;
        ShutterCurve curve = ShutterCurve::box();
        std::shared_ptr<const Aperture> aperture = nullptr;  ///< none: the disc
        std::shared_ptr<const LensView> view = nullptr;      ///< a real lens, whose geometry `lens` then is
    };
    /// `camera` gives raster, projection and the pose at rest. An orthographic camera must come with a
    /// pinhole.
    LensCamera(const Camera& camera, const CameraModel& model, const Settings& settings);

    /// Sixteen samples whose points of the lens are known: in units of its radius, raster axes. Not for a
    /// real lens.
    struct PointSamples {
        alignas(64) std::array<float, 16> x, y;
        std::array<glm::dvec2, 16> lens;
        alignas(64) std::array<float, 16> time;
    };
    /// As add_rays: of the same points of the lens the same rays, but for rounding.
    void add_rays(const PointSamples& samples, RayBatch& batch, std::vector<float>& weights) const;

    /// Adds one group of 16 rays to the batch: unit directions, times where the batch has them. `weights`, by
    /// ray, gets the share of its light that each lets through, where not all do; rays without any reach
    /// nothing.
    void add_rays(const LensSamples& samples, RayBatch& batch, std::vector<float>& weights) const;
    /// Whether some rays are lost on their way through the lens; else `weights` stays empty.
    [[nodiscard]] bool loses_rays() const { return view_ || (aperture_ && aperture_->varies_over_field()); }

    /// One of them in double: slow and obvious, for tests. `time`: share of the time span.
    struct Ray {
        glm::dvec3 origin{0}, direction{0, 0, -1};
        double time = 0;
        double weight = 1;
    };
    [[nodiscard]] Ray ray(double x, double y, double lens_u, double lens_v, double time) const;

    /// Where the pinhole sees what a ray through a point of the lens (in units of its radius), which it would
    /// see at (x, y) in the plane in focus, meets after `t` m; raster px. Not for a real lens.
    [[nodiscard]] glm::dvec2 pinhole_px(double x, double y, const glm::dvec2& unit, double t) const;

    /// px per metre across the view for a point of the world; 0 behind the camera.
    [[nodiscard]] double px_per_m(const glm::dvec3& world, double time_s) const;
    [[nodiscard]] bool moves() const { return moves_; }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

  private:
    // Metres on the lens and tangents of directions, in raster axes; what SIMD makes of samples.
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
    /// Towards the point of the focal plane that the pinhole sees at (x, y). Whether it gets through.
    bool local_ray(double x, double y, const glm::dvec2& unit, std::size_t lane, Local& out) const;
    /// From rays in the camera's frame on.
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
    std::shared_ptr<const Aperture> aperture_;  ///< none: the disc
    std::shared_ptr<const LensView> view_;      ///< none: a thin lens
    Optics optics_{};
    TimeSpan span_;
    ShutterCurve curve_;
    bool even_time_;
    Frame rest_, still_;  // before the camera's motion; at the shutter's opening
    MotionPath path_;
};

}  // namespace postlens
