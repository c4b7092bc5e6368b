// Tests whether different paths name the same file.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace postlens {

/// A text that is equal for two paths of the same file, absolute or relative, also through `.`, `..`,
/// symbolic and hard links. For a file that does not exist, its folder and name decide.
[[nodiscard]] std::string file_identity(const std::filesystem::path& path);

/// Throws Error(wrong_arguments) if one of the files `read` is among those to be `written`.
void refuse_overwriting(std::span<const std::filesystem::path> read,
                        std::span<const std::filesystem::path> written);

}  // namespace postlens
