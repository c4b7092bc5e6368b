// Some of a mesh's sheets.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheet_mesh.h"

namespace postlens {

/// The sheets whose entry of `wanted` is not 0, in their order, with all that is theirs; before highlights
/// are taken.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
