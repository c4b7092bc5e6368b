// Adds a camera and a light to scenes that have none, with a note to the user.
#pragma once

#include <optional>

#include "scene/scene.h"

namespace postlens {

/// Adds what is missing in a scene, with a note for each addition:
/// - If there is no camera: a camera with a 50 mm lens and 36 mm film that shows all finite objects. It looks
///   from the direction `view_from` (not along +-y) or, if empty, from the right and above.
/// - If there is no light and `wants_light` is true: a point light of `light_intensity` at the first camera.
///   For an orthographic camera, it is a directional light.
///
/// Throws Error(invalid_input) with the name of the file if there are no objects, or
/// if an object extends beyond `largest_length_m`.
void complete_scene(Scene& scene, const std::filesystem::path& path, bool wants_light, double light_intensity,
                    std::optional<glm::dvec3> view_from = std::nullopt);

/// Returns the horizontal direction in which most mesh surfaces face: the horizontal component of the mean
/// surface normal, weighted by area. In a room without a front wall, it points out of the open front. Returns
/// nothing if the horizontal component is shorter than 0.1 or than the vertical component.
[[nodiscard]] std::optional<glm::dvec3> open_side(const Scene& scene);

/// Returns true if a material reflects light from light sources: diffuse, diffuse_transmission or specular.
[[nodiscard]] bool answers_to_lights(const Scene& scene);

}  // namespace postlens
