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
    /// `motion` is the motion of the scene, and `shutter` the exposure, as a range of times. If `shutter` is
    /// set, every pixel is the average over many lens points and instants. The method `scatter`, which
    /// otherwise computes pixels that show a single surface, is then not used, because it shows only one
    /// instant.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene from which the sample file was traced. Some view samples have colours that the sample file
    /// does not determine. Rays into the scene replace these colours. If `scene` is null, no rays are traced.
    const Scene* scene = nullptr;
    /// If set, this function chooses in which views a ray checks the recorded colour of pixel (x, y): it
    /// appends the indices of these views to `views`. Otherwise, they are chosen at random, and the error of
    /// the image is derived from the checks. A choice by the caller may not be random, so then no error is
    /// derived, and HybridResult::stated is empty.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Fraction of the pixels, in the image or crop, that were computed by the method `scatter` instead of
    /// averaging views. This is faster for pixels that show a single surface. It is 0 with a scene, because
    /// every pixel is then an average of views and rays.
    double scattered_share = 0;
    /// Fraction of the pixels, in the image or crop, for which the sample file is insufficient: it lacks some
    /// of their light, or light is reprojected to a wrong position. If there are many such pixels, the scene
    /// should be traced again. This field is set only if HybridSettings::scene is null, because otherwise
    /// rays add what is missing.
    double wanted_share = 0;
    double retraced_share = 0;  ///< share of the view samples, in the image or crop, that are rays
    RayCounts rays;
    std::optional<StatedError> stated;  ///< set with a scene and at least two views
    /// These two fields have one element per pixel of the whole image, and are set only with a scene. A view
    /// sample is what one view (image from one lens point) sees in the pixel. `traced` is the fraction of the
    /// pixel's view samples that come from rays instead of the file. `checks` contains the differences
    /// between the colours of check rays and the recorded colours.
    std::vector<float> traced;
    std::vector<PixelCheck> checks;
    /// How each pixel of the whole image was computed: 0 by averaging images from many lens points, 1 by
    /// spreading records over their circles of confusion (method `scatter`), 2 mostly by rays.
    std::vector<std::uint8_t> what;
};

/// Makes an image with the lens and shutter of `settings` from the sample file of `frame`. The image is
/// bit-identical for any number of threads. Throws Error(invalid_input) if the file was not traced from
/// `settings.scene`, and the errors of focus_picture and render_picture.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// Makes an image directly from a file. To make several images from one file, use a FocusFrame instead.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
