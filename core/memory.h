// Tests for free memory before it is allocated. Missing memory then causes an error message; otherwise the
// system would kill the process.
#pragma once

#include <cstdint>
#include <string>

namespace postlens {

/// Memory available to programs, bytes, as the system states it; the largest number if the system does not.
[[nodiscard]] std::uint64_t available_memory_bytes();

/// Peak resident set size of this process so far, bytes.
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// Throws Error(out_of_memory) "WHAT needs N MB of memory (M MB are free)" if less than `bytes` of memory is
/// available.
void require_memory(std::uint64_t bytes, const std::string& what);

/// Returns freed memory to the system, where the C library supports this; otherwise the library keeps it for
/// later allocations. Useful between large pieces of work whose allocations have different sizes.
void give_back_memory();

}  // namespace postlens
