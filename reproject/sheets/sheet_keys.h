// Assigns numbers to the surfaces that the recorded rays hit. A surface is identified by its object and the
// sequence of reflections and transmissions that shows it.
#pragma once

#include <cstdint>
#include <vector>

#include "reproject/sheets/sample_surfaces.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

struct SheetKeys {
    std::vector<SheetKey> keys;          ///< ascending, distinct
    std::vector<std::uint32_t> of_node;  ///< index into `keys`
};

/// Finds the surface (SheetKey) to which each node of `trees` belongs.
void find_sheet_keys(const SampleTrees& trees, SheetKeys& out);

}  // namespace postlens
