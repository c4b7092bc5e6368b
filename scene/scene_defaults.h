// Adds a camera and a light to scenes that have none. Each addition makes a note in the scene.
#pragma once

#include <optional>

#include "scene/scene.h"

namespace postlens {

/// Throws Error(invalid_input) with the name of the file if an object extends beyond `largest_length_m` or if
/// there are no objects. Otherwise adds what is missing, with a note:
/// - if there is no camera, one of 50 mm on 36 mm film that sees the bounding box of all finite objects from
///   the direction `view_from` (not along +-y), or else from the right and above;
/// - if there is no light and `wants_light`, a point light of `light_intensity` at the first camera's
///   position (a directional light for an orthographic camera).
void complete_scene(Scene& scene, const std::filesystem::path& path, bool wants_light, double light_intensity,
                    std::optional<glm::dvec3> view_from = std::nullopt);

/// Returns the horizontal direction from which most surfaces of the scene's meshes show their outer side,
/// such as the open front of a room. It is the horizontal part of the mean normal of all triangles, weighted
/// by area. Empty if this part is shorter than a tenth of a unit normal, or shorter than the vertical part.
[[nodiscard]] std::optional<glm::dvec3> open_side(const Scene& scene);

/// True if a material reflects the light of light sources: if one of diffuse, diffuse_transmission and
/// specular is not black.
[[nodiscard]] bool answers_to_lights(const Scene& scene);

}  // namespace postlens
