// Reads the [[object]] tables of a .toml scene, with shapes, instances, repetitions and motion.
#pragma once

#include "core/toml_reader.h"
#include "scene/scene.h"

namespace postlens {

/// Greatest number of shapes in a scene. Without this limit, instances of repeated instances could make the
/// number grow exponentially.
inline constexpr std::size_t largest_shape_count = 1'000'000;

/// Appends the objects of the file to scene.objects. scene.materials and scene.time_s must already be set. A
/// default material is appended to scene.materials if an object has no material.
void read_objects(const TomlTable& root, double metres_per_unit, Scene& scene);

}  // namespace postlens
