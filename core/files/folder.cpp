#include "core/files/folder.h"

#include <system_error>

#include "core/error.h"

namespace postlens {

void make_folder(const std::filesystem::path& path) {
    std::error_code error, none;
    std::filesystem::create_directory(path, error);
    if (std::filesystem::is_directory(path, none)) return;
    if (std::filesystem::exists(path, none))
        fail(ExitCode::cannot_write, "{}: is a file (expected a folder, or a name that is free)",
             path.string());
    fail(ExitCode::cannot_write, "{}: cannot make this folder ({})", path.string(), error.message());
}

}  // namespace postlens
