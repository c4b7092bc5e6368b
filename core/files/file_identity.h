// Tests whether different paths name the same file.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace postlens {

/// Returns a text that is equal for all paths of one file: absolute and relative paths, and paths through
/// `.`, `..`, symbolic links and hard links. If the file does not exist, its folder and name determine the
/// text.
[[nodiscard]] std::string file_identity(const std::filesystem::path& path);

/// Throws Error(wrong_arguments) if a file that will be `written` is also one of the files that are `read`.
void refuse_overwriting(std::span<const std::filesystem::path> read,
                        std::span<const std::filesystem::path> written);

}  // namespace postlens
