// Names and lists the result tables, one per share (part of the work), that a sweep or a chart leaves in one
// folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/share.h"

namespace postlens {

/// Name of the table of a share: "STEM.I-of-N.json".
[[nodiscard]] std::string share_table_name(std::string_view stem, const Share& share);

/// The result tables of all shares in a folder, sorted by file name.
[[nodiscard]] std::vector<std::filesystem::path> share_tables(const std::filesystem::path& folder,
                                                              std::string_view stem);

}  // namespace postlens
