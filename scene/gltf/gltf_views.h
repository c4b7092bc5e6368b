// Reads the camera and the light of a glTF node. Both are at the node's origin and point along -z.
#pragma once

#include <optional>

#include "scene/gltf/gltf_document.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"

namespace postlens {

/// The camera of a node, if it has one. Throws Error(invalid_input).
[[nodiscard]] std::optional<Camera> gltf_camera(const GltfDocument& document, const JsonPlace& node,
                                                double metres_per_unit);

/// The light of a node (KHR_lights_punctual), if it has one. Its intensity is the file's, in lux or candela,
/// divided by (pi lumens_per_watt): the radiance of a white diffuse surface lit by it. Throws
/// Error(invalid_input).
[[nodiscard]] std::optional<Light> gltf_light(const GltfDocument& document, const JsonPlace& node,
                                              const SceneReadOptions& options, SceneNotes& notes);

}  // namespace postlens
