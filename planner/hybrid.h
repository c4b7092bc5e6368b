// Makes a light field image with a given number of views. Rays replace the view samples that the records do
// not determine.
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
    /// Motion during the exposure. With a `shutter`, every pixel is computed as a light field, and none by
    /// `scatter`.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene from which the file was traced. Rays into the scene replace the view samples that the
    /// records do not determine. Null: no rays.
    const Scene* scene = nullptr;
    /// For measurements with a scene: selects, in each half of the views, the view samples that are compared
    /// with rays (FieldViews::checked). If set, the image's error is not stated.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Without a scene: share of the pixels of the image or its crop that are scattered.
    double scattered_share = 0;
    /// Without a scene: share of the pixels of the image or its crop whose records are insufficient.
    double wanted_share = 0;
    double retraced_share = 0;  ///< share of the views' samples, in the image or its crop, that are rays
    RayCounts rays;
    std::optional<StatedError> stated;  ///< with a scene and at least two views
    /// Only with a scene: one value per pixel of the whole image, as defined in FieldFocus.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;
    /// Per pixel of the whole image: 0 light field, 1 scattered, 2 mostly rays.
    std::vector<std::uint8_t> what;
};

/// Makes the image, bit-identical for any number of threads. Throws Error(invalid_input) if the file was not
/// traced from `scene`, and the errors of focus_picture and render_picture.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// Makes a single image of a file. Throws the same errors as hybrid_picture for a FocusFrame.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
