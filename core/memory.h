// Tests for free memory before it is allocated, so that a lack of memory causes an error message and not a
// killed process.
#pragma once

#include <cstdint>
#include <string>

namespace postlens {

/// Memory that the system states as available to programs, bytes; the largest number if it states none.
[[nodiscard]] std::uint64_t available_memory_bytes();

/// Peak resident set size of this process so far, bytes.
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// Throws Error(out_of_memory) "WHAT needs N MB of memory (M MB are free)" if fewer than `bytes` are
/// available.
void require_memory(std::uint64_t bytes, const std::string& what);

/// Returns freed memory that the C library keeps for later allocations to the system, if the library can. For
/// work in large parts whose allocations have different sizes.
void give_back_memory();

}  // namespace postlens
