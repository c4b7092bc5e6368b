// Which sheets the nodes of some point samples belong to, as numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "reproject/sample_surfaces.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

struct SheetKeys {
    std::vector<SheetKey> keys;          ///< in growing order, each once
    std::vector<std::uint32_t> of_node;  ///< index into `keys`
};

/// By node of `trees`.
void find_sheet_keys(const SampleTrees& trees, SheetKeys& out);

}  // namespace postlens
