// Tests whether output will fit on the disk, before work is spent on it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace postlens {

/// Free space, bytes, of the file system that `target` is on or will be on; the largest number if the system
/// does not state it. Follows links.
[[nodiscard]] std::uint64_t free_disk_bytes(const std::filesystem::path& target);

/// Throws Error(cannot_write) "TARGET: cannot write (needs about N MB, M MB are free; HINT)" if `bytes` is
/// more than `free_bytes`.
void require_disk(std::uint64_t bytes, std::uint64_t free_bytes, const std::filesystem::path& target,
                  const std::string& hint);

}  // namespace postlens
