#include "core/files/file_identity.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unordered_set>

#include "core/error.h"

namespace postlens {

std::string file_identity(const std::filesystem::path& path) {
    // Device and inode numbers identify a file, whatever its path. std::filesystem::equivalent can only
    // compare two paths.
    struct stat there {};
    if (::stat(path.c_str(), &there) == 0) return fmt::format("{}:{}", there.st_dev, there.st_ino);
    std::error_code error;
    const std::filesystem::path absolute = std::filesystem::absolute(path, error);
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(absolute, error);
    return error ? absolute.lexically_normal().string() : canonical.string();
}

void refuse_overwriting(std::span<const std::filesystem::path> read,
                        std::span<const std::filesystem::path> written) {
    std::unordered_set<std::string> outputs;
    for (const auto& path : written) outputs.insert(file_identity(path));
    for (const auto& path : read) {
        if (outputs.contains(file_identity(path))) {
            fail(ExitCode::wrong_arguments, "--output: would overwrite the input {} (expected another place)",
                 path.string());
        }
    }
}

}  // namespace postlens
