#include "core/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace postlens {
namespace fs = std::filesystem;

OutputFile::OutputFile(fs::path target) : target_(std::move(target)) {
    std::error_code ec;
    if (target_.filename().empty() || fs::is_directory(target_, ec)) {
        fail(ExitCode::cannot_write, "{}: cannot write (got a folder; expected a file name)", target_.string());
    }
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ec)) {
        fail(ExitCode::cannot_write, "{}: cannot write (folder {} does not exist)", target_.string(),
             folder.string());
    }
    // Keeping the ending last lets image writers choose the format; the pid keeps two runs apart.
    temporary_ = folder / fmt::format(".{}.{}.part{}", target_.stem().string(), static_cast<int>(::getpid()),
                                      target_.extension().string());
    const int fd = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) {
        fail(ExitCode::cannot_write, "{}: cannot write ({})", target_.string(), std::strerror(errno));
    }
    ::close(fd);
}

OutputFile::~OutputFile() {
    if (!committed_) {
        std::error_code ec;
        fs::remove(temporary_, ec);
    }
}

void OutputFile::commit() {
    const int fd = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0 || ::fsync(fd) != 0) {
        const int error = errno;
        if (fd >= 0) ::close(fd);
        fail(ExitCode::cannot_write, "{}: cannot write ({})", target_.string(), std::strerror(error));
    }
    ::close(fd);
    std::error_code ec;
    fs::rename(temporary_, target_, ec);
    if (ec) fail(ExitCode::cannot_write, "{}: cannot write ({})", target_.string(), ec.message());
    committed_ = true;
}

}  // namespace postlens
