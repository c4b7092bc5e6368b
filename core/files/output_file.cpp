#include "core/files/output_file.h"

#include <array>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace postlens {
namespace fs = std::filesystem;
namespace {

// Paths of the temporary files that exist now, so that the signal handler can delete them if the program is
// interrupted. Whoever uses or frees a path first exchanges its pointer for null. So a thread and the handler
// never use the same path at once.
constexpr std::size_t slot_count = 64;
std::array<std::atomic<char*>, slot_count> g_temporaries{};
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler may touch only lock-free atomics");

std::optional<std::size_t> list_temporary(const fs::path& path) {
    char* text = ::strdup(path.c_str());
    if (text == nullptr) return std::nullopt;
    for (std::size_t i = 0; i < slot_count; ++i) {
        char* expected = nullptr;
        if (g_temporaries[i].compare_exchange_strong(expected, text)) return i;
    }
    std::free(text);
    return std::nullopt;
}

void unlist_temporary(std::optional<std::size_t> slot) {
    if (slot) std::free(g_temporaries[*slot].exchange(nullptr));
}

[[noreturn]] void fail_to_write(const fs::path& target, int error) {
    fail(ExitCode::cannot_write, "{}: cannot write ({})", target.string(),
         std::generic_category().message(error));
}

int open_retrying(const fs::path& path, int flags) {
    int fd = -1;
    do {
        fd = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    } while (fd < 0 && errno == EINTR);
    return fd;
}

/// Returns 0, or the errno of the call that failed.
int flush_to_disk(const fs::path& path, int flags) {
    const int fd = open_retrying(path, flags);
    if (fd < 0) return errno;
    int result = -1;
    do {
        result = ::fsync(fd);
    } while (result != 0 && errno == EINTR);
    const int error = result == 0 ? 0 : errno;
    ::close(fd);
    // EINVAL and ENOTSUP are not failures: they mean that the file system does not support fsync.
    return error == EINVAL || error == ENOTSUP ? 0 : error;
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

OutputFile::OutputFile(fs::path target) : target_(std::move(target)), destination_(target_) {
    std::error_code ec;
    const fs::file_status status = fs::status(target_, ec);
    if (target_.filename().empty() || fs::is_directory(status)) {
        fail(ExitCode::cannot_write, "{}: cannot write (got a folder; expected a file name)",
             target_.string());
    }
    if (fs::exists(status)) {
        // The finished file is renamed to the target, which would replace a device such as /dev/null by an
        // ordinary file.
        if (!fs::is_regular_file(status)) {
            fail(ExitCode::cannot_write, "{}: cannot write (got a device, pipe or socket; expected a file)",
                 target_.string());
        }
        // The finished file is renamed to the target. This succeeds even if the target is write-protected, so
        // write permission is checked here.
        if (::access(target_.c_str(), W_OK) != 0) fail_to_write(target_, errno);
    }
    // Follows symbolic links. If `destination_` is a link, it is replaced by the path to which the link
    // leads, so that the file is written there and the link stays. The file at this path need not exist yet.
    constexpr int most_links = 40;  // the limit of the operating system
    for (int links = 0; fs::is_symlink(fs::symlink_status(destination_, ec)); ++links) {
        if (links == most_links) fail_to_write(target_, ELOOP);
        const fs::path link = fs::read_symlink(destination_, ec);
        if (ec) fail_to_write(target_, ec.value());
        destination_ = folder_of(destination_) / link;
    }
    const fs::path folder = folder_of(destination_);
    if (!fs::is_directory(folder, ec)) {
        const bool is_file = fs::is_regular_file(folder, ec);
        fail(ExitCode::cannot_write, "{}: cannot write ({})", target_.string(),
             is_file ? fmt::format("{} is a file; expected a folder", folder.string())
                     : fmt::format("folder {} does not exist", folder.string()));
    }
    // The temporary file has the extension of the output file, because image writers choose the format by the
    // extension. `number` makes the name unique: processes in different containers may have equal process
    // ids.
    const std::string stem = destination_.stem().string().substr(0, 200);
    int fd = -1;
    for (int number = 0; fd < 0; ++number) {
        temporary_ = folder / fmt::format(".{}.{}-{}.part{}", stem, ::getpid(), number,
                                          destination_.extension().string());
        fd = open_retrying(temporary_, O_WRONLY | O_CREAT | O_EXCL);
        if (fd < 0 && errno != EEXIST) fail_to_write(target_, errno);
    }
    ::close(fd);
    slot_ = list_temporary(temporary_);
}

OutputFile::~OutputFile() {
    if (!committed_) {
        std::error_code ec;
        fs::remove(temporary_, ec);
    }
    unlist_temporary(slot_);
}

void OutputFile::write(std::string_view bytes) {
    std::FILE* out = std::fopen(temporary_.c_str(), "wb");
    bool ok = out != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
    int error = errno;
    if (out != nullptr && std::fclose(out) != 0 && ok) {
        ok = false;
        error = errno;
    }
    if (!ok) fail(ExitCode::cannot_write, "{}: cannot write ({})", target_.string(), std::strerror(error));
}

void OutputFile::commit() {
    assert(!committed_);
    if (const int error = flush_to_disk(temporary_, O_RDONLY); error != 0) fail_to_write(target_, error);
    std::error_code ec;
    fs::rename(temporary_, destination_, ec);
    if (ec) fail_to_write(target_, ec.value());
    committed_ = true;
    // A file name is stored in the folder that contains the file. Therefore, after the temporary file has
    // been renamed, its folder must be written to the disk too. Otherwise, the new name could be lost in a
    // power failure.
    // Errors are ignored, because the file itself is complete, and some folders cannot be opened for reading.
    static_cast<void>(flush_to_disk(folder_of(destination_), O_RDONLY | O_DIRECTORY));
}

void write_file(const fs::path& target, std::string_view bytes) {
    OutputFile file(target);
    file.write(bytes);
    file.commit();
}

void remove_all_temporaries() noexcept {
    for (std::atomic<char*>& slot : g_temporaries) {
        if (const char* path = slot.exchange(nullptr)) ::unlink(path);
    }
}

}  // namespace postlens
