// Checks whether different paths lead to the same file.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace postlens {

/// Returns a text that identifies a file: it is the same for every path to the file, also through links. For
/// a missing file, the text consists of the file's folder and name.
[[nodiscard]] std::string file_identity(const std::filesystem::path& path);

/// Throws Error(wrong_arguments) if one of the files in `written` is also in `read`.
void refuse_overwriting(std::span<const std::filesystem::path> read,
                        std::span<const std::filesystem::path> written);

}  // namespace postlens
