// Reads the camera and the light of a glTF node. Both are at the origin of the node and point along -z.
#pragma once

#include <optional>

#include "scene/gltf/gltf_document.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"

namespace postlens {

/// Returns the camera of a node, or empty if the node has none. Throws Error(invalid_input).
[[nodiscard]] std::optional<Camera> gltf_camera(const GltfDocument& document, const JsonPlace& node,
                                                double metres_per_unit);

/// Returns the light of a node (KHR_lights_punctual), or empty if the node has none. The file gives the
/// intensity in lux or candela, but a Light needs the radiance of a white diffuse surface in this light.
/// Therefore, the intensity is divided by `options.lumens_per_watt` and by pi. Throws Error(invalid_input).
[[nodiscard]] std::optional<Light> gltf_light(const GltfDocument& document, const JsonPlace& node,
                                              const SceneReadOptions& options, SceneNotes& notes);

}  // namespace postlens
