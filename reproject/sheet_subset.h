// A mesh with a subset of the sheets of another.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheet_mesh.h"

namespace postlens {

/// Copies the sheets whose entry of `wanted` is not 0, in the same order, with their cells and texels. Call
/// it before take_highlights.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
