// Where a scene's things stand and how they move: the transform keys of .toml scenes and paths.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "core/toml_reader.h"
#include "records/transform_key.h"

namespace postlens {

/// What a length may be in a file whose lengths are multiplied by `metres_per_unit`.
[[nodiscard]] NumberRange length_range(double metres_per_unit);
/// What a radius or another extent may be.
[[nodiscard]] NumberRange extent_range(double metres_per_unit);

/// The vector of a key, made unit length; empty where the key is absent. Refuses one of length 0.
[[nodiscard]] std::optional<glm::dvec3> read_direction(const TomlTable& table, std::string_view key);

/// Keys of a transform that does not move.
inline constexpr std::array<std::string_view, 6> transform_keys{
    "translate_m", "rotate_degrees", "rotate_axis", "quaternion", "scale", "matrix"};

/// translate * rotate * scale, or the matrix; the identity where the table has none of the keys.
[[nodiscard]] glm::dmat4 read_transform(const TomlTable& table, double metres_per_unit);

/// The array `keys` of the table: instants in growing order. `rigid`: refuses a scale. Empty where absent.
[[nodiscard]] std::vector<TransformKey> read_motion(const TomlTable& table, double metres_per_unit,
                                                    bool rigid);

}  // namespace postlens
