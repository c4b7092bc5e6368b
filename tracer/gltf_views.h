// Cameras and lights of a glTF document, where a node has one; at the origin, looking along -z.
#pragma once

#include <optional>

#include "tracer/gltf_document.h"
#include "tracer/scene.h"
#include "tracer/scene_notes.h"

namespace postlens {

/// The camera of a node. Throws Error(invalid_input).
[[nodiscard]] std::optional<Camera> gltf_camera(const GltfDocument& document, const JsonPlace& node,
                                                double metres_per_unit);

/// The light of a node (KHR_lights_punctual). Candelas and lux become intensities by 1 / pi: what a white
/// matt surface shows of them. Throws Error(invalid_input).
[[nodiscard]] std::optional<Light> gltf_light(const GltfDocument& document, const JsonPlace& node,
                                              double metres_per_unit, SceneNotes& notes);

}  // namespace postlens
