// Distributed rays for the pixels that records do not suffice for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lens/aperture.h"
#include "planner/hybrid.h"
#include "records/sample_file.h"
#include "tracer/render.h"
#include "tracer/scene.h"

namespace postlens {

/// The name of the camera that the file was traced through, in its own scene. Throws Error(invalid_input)
/// for another scene, and for one without such a camera.
[[nodiscard]] std::string checked_camera(const SampleHeader& header, const Scene& scene);

/// Throws Error(wrong_arguments) where the scene's exposure is not that by which the file is read.
void check_exposed_alike(const Scene& scene, const SampleFileReader& file);

/// What `render` would be asked for to make the same picture.
[[nodiscard]] RenderSettings retrace_settings(const SampleHeader& header, const HybridSettings& settings,
                                              const std::string& camera, const Aperture& aperture);

/// Leaves those at the front of `pixels` that are no more than a share of all; where that is not all of them,
/// it warns.
void limit_retraced(double most_retraced, std::vector<std::uint32_t>& pixels, HybridResult& out);

/// Traces pixels of the picture in `out` again. Adds to `what`, `rays` and `retraced_share`.
void retrace(const Scene& scene, const RenderSettings& render, std::vector<std::uint32_t> pixels,
             HybridResult& out);

}  // namespace postlens
