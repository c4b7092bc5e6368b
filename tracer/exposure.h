// The exposure of a scene: the scale of its light relative to white (docs/exposure.md).
#pragma once

#include <string>

#include "scene/scene.h"
#include "tracer/camera_model.h"

namespace postlens {

/// Sets the colours of all light in the scene to 2^stops times those in its file. At 0 stops they equal those
/// in the file exactly.
void expose(Scene& scene, double stops);

/// Returns the exposure, stops, of `--exposure auto`: auto_exposure_of (pictures/exposure.h) for the largest
/// colour channel of each pixel in a preview of the scene. The preview shows the default instant without
/// exposure. It is 96 px long on its longer side, and traces one shading tree through the centre of each
/// pixel, with at most 5 nodes along a path. The result depends on the aspect ratio of the image but not on
/// its size, and is bit-identical for any number of threads. Throws the errors of find_camera and
/// CameraModel.
[[nodiscard]] double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                                         const CameraOverrides& overrides);

}  // namespace postlens
