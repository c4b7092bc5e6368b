// Copies selected sheets (parts of surfaces within squares of 16 x 16 raster px) to a new mesh.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Copies the sheets (parts of surfaces) with a nonzero entry in `wanted`, in the same order.
/// SheetMesh::highlights is not copied, so call take_highlights afterwards to select them.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
