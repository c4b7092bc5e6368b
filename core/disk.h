// Asking for room on a disk before work is spent on what will not fit there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace postlens {

/// What may still be written to the file system that `target` is on or will be on, bytes; the largest number
/// where the system does not say. Links are followed.
[[nodiscard]] std::uint64_t free_disk_bytes(const std::filesystem::path& target);

/// Throws Error(cannot_write) "TARGET: cannot write (needs about N MB, M MB are free; HINT)" where `bytes`
/// are more than are free.
void require_disk(std::uint64_t bytes, std::uint64_t free_bytes, const std::filesystem::path& target,
                  const std::string& hint);

}  // namespace postlens
