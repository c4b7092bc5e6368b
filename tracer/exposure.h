// The exposure of a scene, in stops (docs/exposure.md).
#pragma once

#include <string>

#include "scene/scene.h"
#include "tracer/camera_model.h"

namespace postlens {

/// Multiplies all light of the scene by 2^stops, relative to the scene file.
/// An earlier exposure is replaced.
void expose(Scene& scene, double stops);

/// Returns the exposure, in stops, that `--exposure auto` uses.
/// A preview of the scene, 96 px on its longer side, is traced at the default instant without exposure.
/// Each pixel contributes its largest colour channel to auto_exposure_of (pictures/exposure.h).
///
/// The result depends on the aspect ratio of the image but not on its size.
/// It is bit-identical for any number of threads. Throws the errors of find_camera and CameraModel.
[[nodiscard]] double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                                         const CameraOverrides& overrides);

}  // namespace postlens
