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
    /// Motion of the scene, and the exposure. With an exposure (`shutter`), every pixel is averaged over lens
    /// points and instants. The method `scatter` averages over neither, so it is not used.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene from which the file was traced. Rays into it replace samples whose colours the file does not
    /// determine. If null, no rays are traced.
    const Scene* scene = nullptr;
    /// Optional choice of the views in which a ray checks the recorded colour of pixel (x, y): appends their
    /// indices to `views`. The choice need not be random, so no error is derived from it:
    /// HybridResult::stated is empty.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Fraction of the pixels of the image or crop that the method `scatter` computed instead of averaging
    /// views. It is 0 with a scene, because all pixels are then averages of views and rays.
    double scattered_share = 0;
    /// Fraction of the pixels in which the sample file lacks light or reprojects it to a wrong position, so
    /// that the scene should be traced again. Set only if HybridSettings::scene is null.
    double wanted_share = 0;
    double retraced_share = 0;  ///< share of the view samples, in the image or crop, that are rays
    RayCounts rays;
    std::optional<StatedError> stated;  ///< set with a scene and at least two views
    /// Set only with a scene; one element per pixel of the whole image. `traced` is the fraction of a pixel's
    /// view samples that are rays; `checks` contains differences between rays and recorded colours.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;
    /// How each pixel of the whole image was computed: 0 by averaging images from many lens points, 1 by
    /// spreading records over their circles of confusion (method `scatter`), 2 mostly by rays.
    std::vector<std::uint8_t> what;
};

/// Makes an image from the sample file of `frame`, bit-identical for any number of threads. Throws
/// Error(invalid_input) if the file was not traced from `settings.scene`, and the errors of focus_picture and
/// render_picture.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// Makes an image directly from a file. To make several images from one file, use a FocusFrame instead.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
