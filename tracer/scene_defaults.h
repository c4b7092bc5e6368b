// What a scene file leaves out and a picture needs: a camera, a light. Each is noted in the scene.
#pragma once

#include "tracer/scene.h"

namespace postlens {

/// Throws Error(invalid_input), naming the file, where an object reaches beyond `largest_length_m` or where
/// there are no objects at all. Then adds, with a note each:
/// - where there is no camera, one of 50 mm on 36 mm film that sees the box around all finite objects;
/// - where there is no light and `wants_light`, a point light of `light_intensity` at the first camera's eye
/// (a
///   directional one for an orthographic camera).
void complete_scene(Scene& scene, const std::filesystem::path& path, bool wants_light,
                    double light_intensity);

/// True where some material answers to lights: diffuse, diffuse_transmission or specular is not black.
[[nodiscard]] bool answers_to_lights(const Scene& scene);

}  // namespace postlens
