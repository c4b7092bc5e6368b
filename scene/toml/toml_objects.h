// The [[object]] tables of a .toml scene: shapes, instances, repetitions, motion.
#pragma once

#include "core/toml_reader.h"
#include "scene/scene.h"

namespace postlens {

/// Greatest number of shapes in a scene. Without a limit, instances of repeated instances grow exponentially.
inline constexpr std::size_t largest_shape_count = 1'000'000;

/// Appends the objects of the file to scene.objects; scene.materials and scene.time_s must be set. An object
/// without a material gets a default material, which is appended to scene.materials.
void read_objects(const TomlTable& root, double metres_per_unit, Scene& scene);

}  // namespace postlens
