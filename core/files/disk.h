// Checks whether output will fit on the disk, before it is computed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace postlens {

/// Returns the free space, in bytes, of the file system on which `target` is or will be created. If it is
/// unknown, returns the largest representable number.
[[nodiscard]] std::uint64_t free_disk_bytes(const std::filesystem::path& target);

/// Throws Error(cannot_write) "TARGET: cannot write (needs about N MB, M MB are free; HINT)" if `bytes`
/// exceeds `free_bytes`.
void require_disk(std::uint64_t bytes, std::uint64_t free_bytes, const std::filesystem::path& target,
                  const std::string& hint);

}  // namespace postlens
