// Copies selected sheets (parts of surfaces within squares of 16 x 16 raster px) to a new mesh.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Returns a copy of `mesh` that contains only some of its sheets (parts of surfaces). The sheets with a
/// nonzero element in `wanted` are copied, in the same order as in `mesh`. The list SheetMesh::highlights is
/// not copied. Therefore, call take_highlights afterwards, which selects the highlights of the copy.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
