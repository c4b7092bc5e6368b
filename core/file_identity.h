// Which file a path means, however it is written.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace postlens {

/// Equal for two paths that name one file: through symbolic and hard links, `.` and `..`, absolute or not. Of
/// a file that is not there yet: by the folder it would lie in.
[[nodiscard]] std::string file_identity(const std::filesystem::path& path);

/// Throws Error(wrong_arguments) where one of `read` is among the files that are to be `written`.
void refuse_overwriting(std::span<const std::filesystem::path> read,
                        std::span<const std::filesystem::path> written);

}  // namespace postlens
