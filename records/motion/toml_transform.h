// Reads transforms and keyframed motion from .toml scenes and from .toml files of motion paths.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "core/toml_reader.h"
#include "records/motion/transform_key.h"

namespace postlens {

/// Returns the accepted range of a length, in units of `metres_per_unit`.
[[nodiscard]] NumberRange length_range(double metres_per_unit);
/// Returns the accepted range of an object's extent, such as a radius, in a TOML file. The range is in the
/// unit of length of the file. One such unit is `metres_per_unit` metres.
[[nodiscard]] NumberRange extent_range(double metres_per_unit);

/// Reads a vector and normalises it. Returns an empty value if the key is absent. Throws if the length is 0.
[[nodiscard]] std::optional<glm::dvec3> read_direction(const TomlTable& table, std::string_view key);

/// The keys in a TOML table that describe a constant transform.
inline constexpr std::array<std::string_view, 6> transform_keys{
    "translate_m", "rotate_degrees", "rotate_axis", "quaternion", "scale", "matrix"};

/// Reads a constant transform from a table: the key `matrix`, or keys for translation, rotation and scale,
/// applied as translate * rotate * scale. Returns the identity if there is none of transform_keys.
[[nodiscard]] glm::dmat4 read_transform(const TomlTable& table, double metres_per_unit);

/// Reads the keyframes in the array `keys` of a table, which must be in order of time. Returns an empty list
/// if there is no such array. With `rigid`, a scale is an error.
[[nodiscard]] std::vector<TransformKey> read_motion(const TomlTable& table, double metres_per_unit,
                                                    bool rigid);

}  // namespace postlens
