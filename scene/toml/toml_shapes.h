// Reads the shapes of a .toml scene.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/toml_reader.h"
#include "scene/scene.h"

namespace postlens {

/// Values of the key `shape`. `kind` is an index into this array. An "instance" is a copy of another object.
inline constexpr std::array<std::string_view, 9> shape_kinds{"sphere",   "box",  "disc", "rectangle", "plane",
                                                             "cylinder", "cone", "mesh", "instance"};
inline constexpr std::size_t instance_kind = 8;

/// Returns the keys that only this kind of shape has.
[[nodiscard]] std::span<const std::string_view> shape_keys(std::size_t kind);

/// Reads a shape from the table of an object, in metres in object space. `kind` must not be `instance_kind`.
[[nodiscard]] Shape read_shape(const TomlTable& table, std::size_t kind, double metres_per_unit);

}  // namespace postlens
