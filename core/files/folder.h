// Makes folders for output files.
#pragma once

#include <filesystem>

namespace postlens {

/// Makes a folder, unless it exists. Its parent must exist. Throws Error(cannot_write) if there is no folder
/// afterwards.
void make_folder(const std::filesystem::path& path);

}  // namespace postlens
