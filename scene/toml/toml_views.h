// Reads the [[camera]] and [[light]] tables of a .toml scene.
#pragma once

#include <vector>

#include "core/toml_reader.h"
#include "scene/scene.h"

namespace postlens {

[[nodiscard]] std::vector<Camera> read_cameras(const TomlTable& root, double metres_per_unit);

[[nodiscard]] std::vector<Light> read_lights(const TomlTable& root, double metres_per_unit);

}  // namespace postlens
