// Reads the shapes of a .toml scene.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/toml_reader.h"
#include "scene/scene.h"

namespace postlens {

/// The shapes that an object in a scene file may have, as values of its key `shape`. The functions below
/// identify a shape by `kind`, its index in this array. The shape "instance" stands for a copy of another
/// object.
inline constexpr std::array<std::string_view, 9> shape_kinds{"sphere",   "box",  "disc", "rectangle", "plane",
                                                             "cylinder", "cone", "mesh", "instance"};
inline constexpr std::size_t instance_kind = 8;

/// Returns the keys that only this kind of shape has.
[[nodiscard]] std::span<const std::string_view> shape_keys(std::size_t kind);

/// Reads the shape of an object from its table in the scene file. The result is in metres, in object space.
/// `kind` is the index of the shape in shape_kinds. It must not be `instance_kind`, because an instance has
/// no shape of its own, but copies another object.
[[nodiscard]] Shape read_shape(const TomlTable& table, std::size_t kind, double metres_per_unit);

}  // namespace postlens
