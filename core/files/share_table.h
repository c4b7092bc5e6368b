// Names and lists result tables in a folder. If the work of a sweep or a chart is divided into shares
// (parts), each share writes one table.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/share.h"

namespace postlens {

/// Returns the file name of a share's table, "STEM.I-of-N.json".
[[nodiscard]] std::string share_table_name(std::string_view stem, const Share& share);

/// Returns the paths of all result tables in a folder, one for each share (part of the work), sorted by file
/// name.
[[nodiscard]] std::vector<std::filesystem::path> share_tables(const std::filesystem::path& folder,
                                                              std::string_view stem);

}  // namespace postlens
