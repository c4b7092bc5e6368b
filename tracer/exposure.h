// A scene's exposure: how bright its light is relative to white (docs/exposure.md).
#pragma once

#include <string>

#include "tracer/camera_model.h"
#include "tracer/scene.h"

namespace postlens {

/// Brings the colours of all light in the scene to 2^stops times those of its file; exactly those for 0.
void expose(Scene& scene, double stops);

/// The exposure of `--exposure auto`: auto_exposure_of (records/exposure.h) over the largest channels of a
/// preview of the scene's own radiance, whatever the scene's exposure is. The preview is at the scene's
/// default instant, 96 px along its longer side, one ray of Whitted's model through each pixel's centre,
/// trees of up to 5 nodes along a path. It does not depend on the size of the picture, only on its
/// proportions. The same bits for any number of threads. Throws as find_camera and CameraModel do.
[[nodiscard]] double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                                         const CameraOverrides& camera);

}  // namespace postlens
