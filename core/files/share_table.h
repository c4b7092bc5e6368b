// Names and lists the tables with the results of a sweep or chart. If several machines divide the work, each
// of them computes a share of it, and writes a table of its own results to a folder. The tables are joined
// later.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/share.h"

namespace postlens {

/// Returns the file name of a share's table, "STEM.I-of-N.json".
[[nodiscard]] std::string share_table_name(std::string_view stem, const Share& share);

/// Returns the paths of the result tables of all shares (parts of the work) in a folder, sorted by file name.
[[nodiscard]] std::vector<std::filesystem::path> share_tables(const std::filesystem::path& folder,
                                                              std::string_view stem);

}  // namespace postlens
