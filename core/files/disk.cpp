#include "core/files/disk.h"

#include <limits>
#include <system_error>

#include "core/error.h"

namespace postlens {
namespace fs = std::filesystem;

std::uint64_t free_disk_bytes(const fs::path& target) {
    std::error_code error;
    // A symbolic link may point to another disk, and the file is written there. So the free space is measured
    // at the destination of the link.
    const fs::path destination = fs::weakly_canonical(target, error);
    const fs::path& file = error ? target : destination;
    const fs::space_info space =
        fs::space(file.has_parent_path() ? file.parent_path() : fs::path("."), error);
    if (error || space.available == static_cast<std::uintmax_t>(-1))
        return std::numeric_limits<std::uint64_t>::max();
    return space.available;
}

void require_disk(std::uint64_t bytes, std::uint64_t free_bytes, const fs::path& target,
                  const std::string& hint) {
    if (bytes <= free_bytes) return;
    const auto megabytes = [](std::uint64_t n) { return static_cast<double>(n) / 1e6; };
    fail(ExitCode::cannot_write, "{}: cannot write (needs about {:.3g} MB, {:.3g} MB are free; {})",
         target.string(), megabytes(bytes), megabytes(free_bytes), hint);
}

}  // namespace postlens
