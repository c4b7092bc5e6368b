#include "core/files/scratch_file.h"

#include <cstdlib>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace postlens {

ScratchFile::ScratchFile(std::string name) : name_(std::move(name)) {
    std::string folder = (std::filesystem::temp_directory_path() / "postlens_XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr)
        fail(ExitCode::cannot_write, "{}: cannot make a folder there", folder);
    folder_ = folder;
}

ScratchFile::~ScratchFile() {
    std::error_code none;
    std::filesystem::remove_all(folder_, none);
}

}  // namespace postlens
