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
/// It applies auto_exposure_of to a preview of 96 px, traced without exposure at the default instant.
/// The result does not depend on the image's size or on the number of threads.
/// Throws the errors of find_camera and CameraModel.
[[nodiscard]] double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                                         const CameraOverrides& overrides);

}  // namespace postlens
