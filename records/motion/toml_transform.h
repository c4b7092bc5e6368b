// Reads transforms and keyframed motion from .toml scenes and paths.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "core/toml_reader.h"
#include "records/motion/transform_key.h"

namespace postlens {

/// Legal range of a length in a file whose lengths are multiplied by `metres_per_unit`.
[[nodiscard]] NumberRange length_range(double metres_per_unit);
/// Legal range of a radius or another extent in such a file.
[[nodiscard]] NumberRange extent_range(double metres_per_unit);

/// Reads a vector and normalises it. Empty if the key is absent. Throws for a vector of length 0.
[[nodiscard]] std::optional<glm::dvec3> read_direction(const TomlTable& table, std::string_view key);

/// Keys of a table that describe a constant transform.
inline constexpr std::array<std::string_view, 6> transform_keys{
    "translate_m", "rotate_degrees", "rotate_axis", "quaternion", "scale", "matrix"};

/// Reads a constant transform from a table: the product translate * rotate * scale, or the key `matrix`.
/// Returns the identity if the table has none of transform_keys.
[[nodiscard]] glm::dmat4 read_transform(const TomlTable& table, double metres_per_unit);

/// Reads the array `keys` of the table; its elements must be in order of time. Returns an empty list if the
/// array is absent. With `rigid`, throws if a key has a scale.
[[nodiscard]] std::vector<TransformKey> read_motion(const TomlTable& table, double metres_per_unit,
                                                    bool rigid);

}  // namespace postlens
