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
    /// `motion` is the motion of the scene, and `shutter` the interval of the exposure. If `shutter` is set,
    /// every pixel is averaged over many lens points and instants, because the faster method `scatter` would
    /// show only one instant.
    const FrameMotion* motion = nullptr;
    std::optional<TimeSpan> shutter;
    ShutterCurve curve = ShutterCurve::box();
    /// The scene from which the sample file was traced. Rays into the scene compute the colours that the file
    /// does not determine, for instance at edges. If `scene` is null, no rays are traced.
    const Scene* scene = nullptr;
    /// Optional: chooses the views (images from single lens points) in which a ray checks the recorded colour
    /// of pixel (x, y), and appends their indices to `views`. If it is set, HybridResult::stated remains
    /// empty, because an error measured in these views may not be representative.
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked;
};

struct HybridResult {
    FocusResult focus;  ///< image, views, warnings
    /// Fraction of the pixels, in the image or crop, that the faster method `scatter` computed instead of
    /// averaging views. It is 0 if HybridSettings::scene is set, because then every pixel is an average of
    /// views and rays.
    double scattered_share = 0;
    /// Fraction of the pixels, in the image or crop, for which the sample file is insufficient: it lacks some
    /// of their light, or light is reprojected to a wrong position. If there are many, trace the scene again.
    /// This field is set only if HybridSettings::scene is null, because otherwise rays add what is missing.
    double wanted_share = 0;
    double retraced_share = 0;  ///< share of the view samples, in the image or crop, that are rays
    RayCounts rays;
    std::optional<StatedError> stated;  ///< set with a scene and at least two views
    /// For each pixel of the whole image, the fraction of its views (images from single lens points) whose
    /// colour comes from a traced ray instead of the sample file. Set only with a scene.
    std::vector<float> traced;
    /// For each pixel of the whole image, the measured error of its recorded colours. Rays were traced in
    /// some of its views, and compared with the recorded colours. Set only with a scene.
    std::vector<PixelCheck> checks;
    /// How each pixel of the whole image was computed: 0 by averaging images from many lens points, 1 by the
    /// method `scatter`, which spreads each recorded surface point over its circle of confusion, 2 mostly by
    /// rays into the scene.
    std::vector<std::uint8_t> what;
};

/// Makes an image with the lens and shutter of `settings`. The image is the mean of many views (images from
/// different lens points). Their colours come from `frame`, an open sample file, and from rays if
/// `settings.scene` is set. The image is bit-identical for any number of threads. Throws Error(invalid_input)
/// if the file was not traced from `settings.scene`. Also throws the errors of focus_picture and
/// render_picture.
[[nodiscard]] HybridResult hybrid_picture(FocusFrame& frame, const HybridSettings& settings);
/// Makes an image directly from a file. To make several images from one file, use a FocusFrame instead.
[[nodiscard]] HybridResult hybrid_picture(const SampleFileReader& file, const HybridSettings& settings);

}  // namespace postlens
