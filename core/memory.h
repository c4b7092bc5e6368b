// Checks that enough memory is free before memory is allocated. If it is not, the program reports an error
// instead of being killed by the system.
#pragma once

#include <cstdint>
#include <string>

namespace postlens {

/// Returns the memory that the system reports as available to programs, in bytes. Returns the largest
/// representable number if the system reports none.
[[nodiscard]] std::uint64_t available_memory_bytes();

/// Returns the peak resident set size of this process so far, in bytes.
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// Throws Error(out_of_memory) "WHAT needs N MB of memory (M MB are free)" if less than `bytes` of memory is
/// available.
void require_memory(std::uint64_t bytes, const std::string& what);

/// Returns freed memory to the system if the C library supports this. Otherwise the library keeps the memory
/// for later allocations. Call this function between large pieces of work whose allocations differ in size.
void give_back_memory();

}  // namespace postlens
