// Numbers the distinct sheet keys of nodes; a key says to which surface a node belongs.
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

/// Finds for each node of `trees` the key of its surface: object, path and reflecting object.
void find_sheet_keys(const SampleTrees& trees, SheetKeys& out);

}  // namespace postlens
