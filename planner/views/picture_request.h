// Checks the settings of an image, and converts them to two other types: the settings of field_focus, which
// averages images from many lens points, and the settings of the ray tracer.
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

/// Checks whether the image can be made by averaging images from single lens points. Throws
/// Error(wrong_arguments), which names `method` or `--scene`, in these cases:
/// - the sample file is orthographic
/// - the field of view differs from that of the file (`framing` is not `keep`)
/// - the blur is not a mean over lens points (`diffraction`, `lens:`)
/// - the crop exceeds the image
/// - the scene's exposure differs from that of the file
void check_request(const SampleFileReader& file, const HybridSettings& settings, const std::string& method);

/// Returns the settings of field_focus, which makes an image as the mean of images from many lens points: the
/// lens, the shutter and the crop of `settings`. The settings contain no ray tracer, so all colours come from
/// the sample file.
[[nodiscard]] FieldFocusSettings field_settings(const SampleHeader& header, const HybridSettings& settings);

/// Returns settings for the ray tracer, with which its rays can replace colours of the image that `settings`
/// describes: the camera of the scene through which the file was traced, with the lens, focus and shutter of
/// the image. Throws the errors of checked_camera.
[[nodiscard]] RenderSettings ray_settings(const SampleHeader& header, const HybridSettings& settings,
                                          const Aperture& aperture);

}  // namespace postlens
