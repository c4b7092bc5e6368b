// Measures how many recorded instants (keys) reproduce the light that changes while the shutter is open:
// shading, highlights, shadows, reflections and refractions.
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
    double psnr_db = 0;  ///< predicted, with these keys; infinite if no light changes
};

/// Returns the smallest number of evenly spaced keys, of 1, 2, 3, 5, 9, 17 and 33, with which the light of
/// the surfaces has `target_db`, or 33. One key is `recorded_s`, which also belongs to all larger numbers.
///
/// Points of surfaces that a coarse grid of rays sees, each at an instant of its own, are followed through
/// the shutter interval. At 65 instants a ray from the camera finds the radiance of each point that is in
/// view. Images made of K keys show the radiance that linear interpolation between the two keys around an
/// instant gives. The error of a point is that of its mean over time, as encoded value (sRGB); the PSNR is
/// over all points. A point of an area light and a direction of a lobe stand for all, so that shadows and
/// reflections are sharper than they are.
[[nodiscard]] LightKeys light_keys(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                                   double recorded_s, const TimeSpan& shutter, double target_db,
                                   const DistributedSettings& tracing);

}  // namespace postlens
