// A scene's exposure: the scale of its light relative to white (docs/exposure.md).
#pragma once

#include <string>

#include "scene/scene.h"
#include "tracer/camera_model.h"

namespace postlens {

/// Sets the colours of all light in the scene to 2^stops times those of its file. 0 stops give exactly the
/// file's.
void expose(Scene& scene, double stops);

/// The exposure, stops, of `--exposure auto`: auto_exposure_of (pictures/exposure.h) for the largest colour
/// channel of each pixel in a preview of the scene. The preview shows the scene's default instant without its
/// exposure, is 96 px along its longer side, and has one shading tree of at most 5 nodes along a path through
/// each pixel's centre. The result depends on the aspect ratio of the image but not on its size, and has the
/// same bits for any number of threads. Throws as find_camera and CameraModel do.
[[nodiscard]] double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                                         const CameraOverrides& camera);

}  // namespace postlens
