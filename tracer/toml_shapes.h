// The shapes of a .toml scene.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/toml_reader.h"
#include "tracer/scene.h"

namespace postlens {

/// Values of the key `shape`, in the order of `shape_keys` and `read_shape`; "instance" has no shape of its
/// own.
inline constexpr std::array<std::string_view, 9> shape_kinds{"sphere",   "box",  "disc", "rectangle", "plane",
                                                             "cylinder", "cone", "mesh", "instance"};
inline constexpr std::size_t instance_kind = 8;

/// The keys that only this kind of shape has.
[[nodiscard]] std::span<const std::string_view> shape_keys(std::size_t kind);

/// The shape of an object's table, in metres, in the object's own space. Not for `instance_kind`.
[[nodiscard]] Shape read_shape(const TomlTable& table, std::size_t kind, double metres_per_unit);

}  // namespace postlens
