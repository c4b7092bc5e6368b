// Copies selected sheets (surfaces within squares of the raster) to a new mesh.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Copies the sheets with a nonzero entry in `wanted`, in the same order. SheetMesh::highlights is not
/// copied, so call take_highlights afterwards, not before.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
