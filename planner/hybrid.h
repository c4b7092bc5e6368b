// A light field image of a given number of views, in which rays replace what the records do not determine.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "focus/focus.h"
#include "focus/light_field/field_focus.h"
#include "lens/shutter_curve.h"
#include "planner/stated_error.h"
#include "reproject/raster_map.h"
#include "scene/scene.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

struct HybridSettings {
    FocusSettings focus;  ///< lens, aperture, `views`, `crop`; `method` is ignored
    /// Motion during the shutter. With an open shutter no pixel is scattered: all of the image is light
    /// field.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene that the file was traced from. Rays into it replace view samples that the records do not
    /// determine; null: no rays.
    const Scene* scene = nullptr;
    /// For measurements, with a scene: replaces the choice of the view samples that are compared with rays
    /// (FieldViews::checked), for each half of the views. The image's error is then not stated.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
    /// Without a scene: limit for the unknown share of a pixel's light, and for the radiance that nonlinear W
    /// moves. A pixel that exceeds it has insufficient records.
    double tolerated = 0.02;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Without a scene, share of the pixels of the image or its crop that are scattered.
    double scattered_share = 0;
    /// Without a scene, share of the pixels of the image or its crop whose records are insufficient.
    double wanted_share = 0;
    double retraced_share = 0;  ///< share of the view samples of the image or its crop that are rays
    RayCounts rays;
    std::optional<StatedError> stated;  ///< with a scene and at least two views
    /// With a scene, one value per pixel of the whole image, as in FieldFocus.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;
    /// Per pixel of the whole image: 0 light field, 1 scattered, 2 mostly rays.
    std::vector<std::uint8_t> what;
};

/// Throws Error(invalid_input) if the file was not traced from `scene`, and what focus_picture and
/// render_picture throw. The result is bit-identical for any number of threads.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// Makes a single image of a file. Throws what hybrid_picture for a FocusFrame throws.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
