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

/// The light of a node (KHR_lights_punctual). Its intensity is the file's, in lux or candela, over pi times
/// lumens_per_watt: the radiance that a white matt surface shows of it. Throws Error(invalid_input).
[[nodiscard]] std::optional<Light> gltf_light(const GltfDocument& document, const JsonPlace& node,
                                              const SceneReadOptions& options, SceneNotes& notes);

}  // namespace postlens
