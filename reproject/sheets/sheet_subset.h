// Copies selected sheets (surfaces within squares of the raster) to a new mesh.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Copies the sheets (surfaces within squares of the raster) whose entry in `wanted` is not 0, in the same
/// order. Call before take_highlights, because highlights are not copied.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
