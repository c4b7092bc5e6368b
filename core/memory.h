// Checks that enough memory is free before it is allocated. Otherwise the system might kill the program.
#pragma once

#include <cstdint>
#include <string>

namespace postlens {

/// Returns the memory that is available to programs, in bytes. If it is unknown, returns the largest
/// representable number.
[[nodiscard]] std::uint64_t available_memory_bytes();

/// Returns the peak resident set size of this process so far, in bytes.
[[nodiscard]] std::uint64_t peak_memory_bytes();

/// Throws Error(out_of_memory) "WHAT needs N MB of memory (M MB are free)" if less than `bytes` are
/// available.
void require_memory(std::uint64_t bytes, const std::string& what);

/// Returns freed memory to the system, if the C library supports this. Call it between large pieces of work
/// whose allocations differ in size.
void give_back_memory();

}  // namespace postlens
