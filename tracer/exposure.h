// The exposure of a scene: the factor, in stops, by which all its light is multiplied (docs/exposure.md).
#pragma once

#include <string>

#include "scene/scene.h"
#include "tracer/camera_model.h"

namespace postlens {

/// Scales all light of the scene to 2^stops times its brightness in the scene file, except for rounding. An
/// earlier exposure of the scene is replaced.
void expose(Scene& scene, double stops);

/// Returns the exposure, in stops, that `--exposure auto` uses. A small preview of the scene is traced at the
/// default instant, without exposure. auto_exposure_of (pictures/exposure.h) is then applied to the largest
/// colour channel of each of its pixels.
///
/// The longer side of the preview is 96 px. One shading tree, with at most 5 nodes along a path, is traced
/// through the centre of each pixel. The result depends on the aspect ratio of the image but not on its size.
/// It is bit-identical for any number of threads. Throws the errors of find_camera and CameraModel.
[[nodiscard]] double auto_exposure_stops(const Scene& scene, const std::string& camera_name,
                                         const CameraOverrides& overrides);

}  // namespace postlens
