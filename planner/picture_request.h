// What a picture of a sample file asks of the light field and of rays, checked.
#pragma once

#include <string>

#include "focus/field_focus.h"
#include "planner/hybrid.h"
#include "records/sample_file.h"
#include "tracer/render.h"
#include "tracer/scene.h"

namespace postlens {

/// The name of the camera that the file was traced through, in its own scene. Throws Error(invalid_input)
/// for another scene, and for one without such a camera.
[[nodiscard]] std::string checked_camera(const SampleHeader& header, const Scene& scene);

/// Throws Error(wrong_arguments) for another framing than the trace's, an impulse response without points, a
/// crop beyond the picture, and a scene whose exposure is not that by which the file is read; `method` is
/// named in the text.
void check_request(const SampleFileReader& file, const HybridSettings& settings, const std::string& method);

/// The lens, the shutter and the crop, without rays.
[[nodiscard]] FieldFocusSettings field_settings(const SampleHeader& header, const HybridSettings& settings);

/// What `render` would be asked for to make the same picture. Throws what checked_camera throws.
[[nodiscard]] RenderSettings ray_settings(const SampleHeader& header, const HybridSettings& settings,
                                          const Aperture& aperture);

}  // namespace postlens
