// Copies selected sheets (parts of surfaces within squares of 16 x 16 raster px) to a new mesh.
#pragma once

#include <cstdint>
#include <span>

#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Returns a copy of `mesh` that contains only those sheets (parts of surfaces) whose element in `wanted` is
/// nonzero. The selected highlights (bright radiance removed from surfaces) are not copied. Therefore, call
/// take_highlights afterwards.
[[nodiscard]] SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted);

}  // namespace postlens
