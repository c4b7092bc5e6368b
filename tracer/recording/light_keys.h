// Determines at how many instants (keys) a scene must be recorded if its light changes during the exposure.
#pragma once

#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Largest number of keys that light_keys returns.
inline constexpr int most_light_keys = 33;

struct LightKeys {
    int keys = 1;
    double psnr_db = 0;  ///< predicted PSNR with these keys; infinite if no light changes
};

/// Returns the smallest number of evenly spaced keys with which the light reaches a PSNR of `target_db`.
/// The number is 1, 2, 3, 5, 9, 17 or 33. Every larger number must suffice, too. If none does, it is 33.
/// The instant `recorded_s` is always recorded. With 1, it is the only one.
///
/// A coarse grid of rays selects points on surfaces, which are followed through the shutter interval.
/// At 65 instants, rays from the camera find the radiance of the points in view.
/// An image is assumed to interpolate it linearly between the two nearest keys.
/// A point's error is that of its mean over time, as an sRGB value. The PSNR is computed over all points.
///
/// One point represents each area light, and one direction each lobe.
/// Shadows and reflections are therefore sharper here than in images.
[[nodiscard]] LightKeys light_keys(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                                   double recorded_s, const TimeSpan& shutter, double target_db,
                                   const DistributedSettings& tracing);

}  // namespace postlens
