// What a scene file leaves out and a picture needs: a camera, a light. Each is noted in the scene.
#pragma once

#include <optional>

#include "tracer/scene.h"

namespace postlens {

/// Throws Error(invalid_input), naming the file, where an object reaches beyond `largest_length_m` or where
/// there are no objects at all. Then adds, with a note each:
/// - where there is no camera, one of 50 mm on 36 mm film that sees the box around all finite objects, from
/// the
///   direction `view_from` (not along +-y), without one from the right and above;
/// - where there is no light and `wants_light`, a point light of `light_intensity` at the first camera's eye
/// (a
///   directional one for an orthographic camera).
void complete_scene(Scene& scene, const std::filesystem::path& path, bool wants_light, double light_intensity,
                    std::optional<glm::dvec3> view_from = std::nullopt);

/// The side from which most of the scene's meshes show their outside, where that is a side: of a room that is
/// open in front, the front. The area-weighted mean of the normals of all triangles must have at least a
/// tenth of the length that it would have were they all parallel, and point more sideways than up or down; it
/// is turned level.
[[nodiscard]] std::optional<glm::dvec3> open_side(const Scene& scene);

/// True where some material answers to lights: diffuse, diffuse_transmission or specular is not black.
[[nodiscard]] bool answers_to_lights(const Scene& scene);

}  // namespace postlens
