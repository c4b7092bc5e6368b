// Makes an image as the mean of a given number of views (images from different lens points), which are
// reprojected from recorded samples. Rays replace uncertain samples: those at edges, and those without a
// recorded surface.
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
    /// Motion of the scene during the exposure `shutter`. With a shutter, every pixel is averaged over lens
    /// points and instants, so the method `scatter` is not used.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene from which the file was traced. Rays into it replace samples whose colours the file does not
    /// determine. If null, no rays are traced.
    const Scene* scene = nullptr;
    /// Optional: appends to `views` the indices of the views in which a ray checks the recorded colour of
    /// pixel (x, y). If set, the image's error is not stated: HybridResult::stated is empty.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Fraction of the pixels of the image or crop that the method `scatter` computed. It is 0 with a scene,
    /// because `scatter` is not used then.
    double scattered_share = 0;
    /// Fraction of the pixels in which light is missing or misplaced, so that the scene should be traced
    /// again. Set only if HybridSettings::scene is null.
    double wanted_share = 0;
    double retraced_share = 0;  ///< share of the view samples, in the image or crop, that are rays
    RayCounts rays;
    std::optional<StatedError> stated;  ///< set with a scene and at least two views
    /// For each pixel of the whole image; set only with a scene. `traced` is the fraction of the pixel's
    /// samples that are rays; `checks` compares rays with recorded colours.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;
    /// How each pixel of the whole image was computed: 0 as a mean over lens points, 1 by the method
    /// `scatter`, 2 mostly by rays.
    std::vector<std::uint8_t> what;
};

/// Makes the image. The result is bit-identical for any number of threads. Throws Error(invalid_input) if the
/// file was not traced from `scene`, and the errors of focus_picture and render_picture.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// Makes an image directly from a file. To make several images from one file, use a FocusFrame instead.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
