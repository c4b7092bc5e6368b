// Numbers the distinct sheet keys of shading-tree nodes. A sheet key identifies the surface to which a node
// belongs.
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

/// Finds the surface to which each node (hit) of `trees` belongs. Four facts identify a surface: its object,
/// the path from the eye to it, the object that reflects or transmits it, and whether it lies closely behind
/// another surface.
void find_sheet_keys(const SampleTrees& trees, SheetKeys& out);

}  // namespace postlens
