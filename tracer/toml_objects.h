// The [[object]] tables of a .toml scene: shapes, instances, repetitions, motion.
#pragma once

#include "core/toml_reader.h"
#include "tracer/scene.h"

namespace postlens {

/// A scene with more shapes than this is refused: instances of repeated instances grow without bound.
inline constexpr std::size_t largest_shape_count = 1'000'000;

/// Appends to scene.objects what the file's objects make; scene.materials and scene.time_s must be set. An
/// object without a material gets one of all defaults, which is appended to scene.materials.
void read_objects(const TomlTable& root, double metres_per_unit, Scene& scene);

}  // namespace postlens
