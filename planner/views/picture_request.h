// Checks the settings of an image, and converts them to settings of field_focus, which averages reprojected
// views, and of the ray tracer.
#pragma once

#include <string>

#include "focus/light_field/field_focus.h"
#include "planner/hybrid.h"
#include "records/sample_file.h"
#include "scene/scene.h"
#include "tracer/render.h"

namespace postlens {

/// Returns the name of the camera in `scene` through which the file was traced. Throws Error(invalid_input)
/// if there is none, or if the file was traced from another scene.
[[nodiscard]] std::string checked_camera(const SampleHeader& header, const Scene& scene);

/// Throws Error(wrong_arguments), naming `method` or `--scene`, if an image cannot be made by averaging
/// images from single lens points:
/// - the file is orthographic
/// - the field of view differs from that of the trace (`framing` is not `keep`)
/// - the blur is not a mean over lens points (`diffraction`, `lens:`)
/// - the crop exceeds the image
/// - the scene's exposure differs from the file's
void check_request(const SampleFileReader& file, const HybridSettings& settings, const std::string& method);

/// Returns the settings for making the image as a mean of views: lens, shutter and crop. No rays are set, so
/// all colours of the views come from the sample file.
[[nodiscard]] FieldFocusSettings field_settings(const SampleHeader& header, const HybridSettings& settings);

/// Returns the settings with which the ray tracer (`render`) makes the same image as `settings` describes:
/// the scene's camera with this lens, focus and shutter. Throws the errors of checked_camera.
[[nodiscard]] RenderSettings ray_settings(const SampleHeader& header, const HybridSettings& settings,
                                          const Aperture& aperture);

}  // namespace postlens
