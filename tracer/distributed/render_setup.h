// Prepares what `render` needs to trace rays: the translated scene, its RayScene, the lens and the shutter.
#pragma once

#include <optional>

#include "tracer/distributed/lens_camera.h"
#include "tracer/render.h"

namespace postlens {

class RenderSetup {
  public:
    /// Throws Error(wrong_arguments) for settings out of range or missing.
    RenderSetup(const Scene& scene, const RenderSettings& settings);
    RenderSetup(const RenderSetup&) = delete;
    RenderSetup& operator=(const RenderSetup&) = delete;
    RenderSetup(RenderSetup&&) = delete;
    RenderSetup& operator=(RenderSetup&&) = delete;
    ~RenderSetup() = default;

    [[nodiscard]] int width() const { return camera_->width(); }
    [[nodiscard]] int height() const { return camera_->height(); }
    [[nodiscard]] const RayScene& rays() const { return *rays_; }
    [[nodiscard]] const LensCamera& camera() const { return *camera_; }
    [[nodiscard]] const TimeSpan& span() const { return span_; }
    [[nodiscard]] const ThinLens& lens() const { return lens_; }
    [[nodiscard]] double focus_m() const { return focus_m_; }
    /// Returns all inputs that determine the image, as one line of JSON. This line is stored with an
    /// unfinished render. The render can be resumed only if the line is equal to that of the new run.
    [[nodiscard]] std::string fingerprint(const RenderSettings& settings) const;

  private:
    void look_through(const RenderSettings& settings, const CameraModel& model);
    void resolve_lens(const RenderSettings& settings, const Camera& camera, const CameraModel& model,
                      double time_s);
    [[nodiscard]] double depth_at(double x, double y, const CameraModel& model, double time_s) const;

    Scene scene_;
    TimeSpan span_;
    ThinLens lens_;
    double focus_m_ = 0;
    FocusGeometry geometry_;
    std::shared_ptr<const LensView> view_;  ///< null: a thin lens
    std::optional<RayScene> rays_;
    std::optional<LensCamera> camera_;
};

}  // namespace postlens
