// Numbers the distinct sheet keys of nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "reproject/sample_surfaces.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

struct SheetKeys {
    std::vector<SheetKey> keys;          ///< ascending, distinct
    std::vector<std::uint32_t> of_node;  ///< index into `keys`
};

/// Finds the keys of all nodes of `trees`.
void find_sheet_keys(const SampleTrees& trees, SheetKeys& out);

}  // namespace postlens
