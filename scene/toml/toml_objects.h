// Reads the [[object]] tables of a .toml scene, with shapes, instances, repetitions and motion.
#pragma once

#include "core/toml_reader.h"
#include "scene/scene.h"

namespace postlens {

/// Greatest number of shapes in a scene. Instances of repeated instances could make it grow exponentially.
inline constexpr std::size_t largest_shape_count = 1'000'000;

/// Appends the objects of the file to scene.objects. scene.materials and scene.time_s must be set before.
/// For objects without a material, a default material is appended to scene.materials.
void read_objects(const TomlTable& root, double metres_per_unit, Scene& scene);

}  // namespace postlens
