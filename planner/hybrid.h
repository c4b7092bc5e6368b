// A number of views of a picture; rays where the records do not tell what these see.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "focus/field_focus.h"
#include "focus/focus.h"
#include "lens/shutter_curve.h"
#include "planner/stated_error.h"
#include "reproject/raster_map.h"
#include "tracer/ray_scene.h"
#include "tracer/scene.h"
#include "tracer/whitted.h"

namespace postlens {

struct HybridSettings {
    FocusSettings focus;  ///< lens, aperture, `views`, `crop`; `method` does not count
    /// Open for more than an instant: everything is seen by the light field.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene that the file was traced from, for what the records do not show; null: stays as it is.
    const Scene* scene = nullptr;
    /// With the scene: FieldViews's, of either half of the views, in place of the usual checks; nothing is
    /// then decided or stated by them. For measurements.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Without the scene: share of a pixel's light that may be unknown, and radiance that may be misplaced
    /// (W.bend), before the records count as insufficient for it.
    double tolerated = 0.02;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Without the scene, of the pixels of the picture or its crop.
    double scattered_share = 0;
    double wanted_share = 0;  ///< that records do not suffice for
    /// Of the view samples of the picture or its crop.
    double retraced_share = 0;
    RayCounts rays;
    std::optional<StatedError> stated;  ///< with the scene and more than one view
    /// By pixel of the whole picture, with the scene: FieldFocus's.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;
    std::vector<std::uint8_t>
        what;  ///< by pixel of the whole picture: 0 light field, 1 scattered, 2 mostly rays
};

/// Throws Error(invalid_input) for a scene that is not the file's own, and what focus_picture and
/// render_picture throw. Same bits for any number of threads.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// One picture of a file.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
